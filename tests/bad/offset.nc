; 3:1 error[iso-compensation]
G91
G42 D1 G01 X1000 Y0
G01 X1000 Y0
M02
