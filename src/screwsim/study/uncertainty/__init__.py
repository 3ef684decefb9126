"""How sure a figure is: derivatives, tolerances of inputs, samples of them, the model error, measured figures."""
