"""Half-plane stresses under a load, and their histories at points fixed in a moving body."""
