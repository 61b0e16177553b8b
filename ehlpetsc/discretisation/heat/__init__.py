"""Heat: temperatures of the film in the Reynolds equation, of both surfaces, and their step in time."""
