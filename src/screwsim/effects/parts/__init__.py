"""What effects are made of: the parts that they declare (all are in `effects.base`), and laws that several share."""
