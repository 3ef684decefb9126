"""The parts that an effect declares, by what they concern; `effects.base` has all of them."""
