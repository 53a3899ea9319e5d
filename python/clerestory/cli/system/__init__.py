"""Put layers of glazing and shading together to window systems, and rate them."""
