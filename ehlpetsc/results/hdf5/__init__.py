"""HDF5 files: attributes, datasets, rows buffered before they are written, continued results."""
