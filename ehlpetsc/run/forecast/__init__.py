"""A case before its run: what it will show and cost, and whether the model is valid."""
