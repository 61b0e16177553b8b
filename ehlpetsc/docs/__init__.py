"""Site of the project's pages: list of the pages and build command."""
