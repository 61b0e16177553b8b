"""Laws of heat: viscosity and conductivity, the temperature of the film, conduction into the bodies."""
