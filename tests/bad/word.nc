; 3:5 error[iso-word]
G91
G01 X Y5
G01 X1 Y2
M02
