"""Pictures of stresses, histories, damage and its distributions."""
