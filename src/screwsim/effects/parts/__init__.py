"""What effects are made of: parts that they declare (`effects.base` has all of them), laws that several share."""
