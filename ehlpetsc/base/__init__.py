"""Ground of the package, which every room may import."""
