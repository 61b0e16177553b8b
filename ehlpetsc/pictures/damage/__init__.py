"""Pictures of damage and lives."""
