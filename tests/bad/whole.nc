; 4:1 warning[iso-units]
G91
G01 X1.5 Y0.
G01 X1500 Y0
M02
