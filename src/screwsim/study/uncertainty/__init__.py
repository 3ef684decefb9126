"""How sure a figure is: its derivatives, the tolerances of inputs, samples of them, the model error, measured figures."""
