"""A year of daylight in a room: illuminance, direct sun and glare by hour, and what they come to.

Everything is weighed by hours: a step counts for the length of its interval, or for nothing (`Hours.weights`), so that
years in hours and years in minutes give the same.
"""
