"""A small scene: three effects, an ideal gas, no oil."""

SCENE = """\
title: small
machine:
  rotor_diameter: 160 mm
  rotor_length: 176 mm
  volume: {max: 600 cm^3, phi_A: 60 deg}
  suction_port: {area: 40 cm^2, phi_B: 60 deg}
  discharge_port: {area: 12 cm^2, opens: 600 deg, phi_C: 640 deg}
gas: {fluid: R134a, isentropic_exponent: 1.12}
operation:
  speed: 3000 rpm
  suction: {pressure: 1.5 bar, temperature: 283 K}
  discharge: {pressure: 12 bar}
effects:
  suction_port:
  discharge_port:
  tip_leakage: {gap: 50 um}
"""
