"""What is HDF5's: attributes, datasets, rows held before they are written, results that are continued."""
