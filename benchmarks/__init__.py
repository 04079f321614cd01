"""How fast, next to what one would use instead; `make bench` writes docs/performance.md."""
