; 4:1 warning[iso-skip]
G91
G01 X15 Y0
/G01 X1500 Y0
M02
