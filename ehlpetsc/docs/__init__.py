"""The pages of the project as one site: which they are, and the command that builds it."""
