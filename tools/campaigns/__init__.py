import os

# Small products of matrices take four times the processor time on several threads, which wait for each other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
