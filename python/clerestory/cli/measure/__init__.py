"""Plan, store and check measurements of samples, and make models of them."""
