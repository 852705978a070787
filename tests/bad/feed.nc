; 3:12 warning[iso-ignored]
G91
G01 X10 Y5 F100
M02
