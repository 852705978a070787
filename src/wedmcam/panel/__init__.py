"""Front panels of simulated controllers, as text: keys in, what the digits show out.

`keys` says which keys there are, `entry` what is keyed in digit by digit, `zd065` which key does
what in which state; `script` runs lines of keys and of things that happen around the machine.
"""
