"""Speed of the program and of alternatives to it; `make bench` writes docs/performance.md."""
