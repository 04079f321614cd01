"""The only conversions between the units of files and tables and SI: multiply to get SI, divide to leave it."""

MM = 1e-3
G = 1e-3
US = 1e-6
MPA = 1e6
GPA = 1e9
KN = 1e3
