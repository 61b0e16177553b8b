"""HDF5 files: attributes, datasets, buffered rows, continuation of results."""
