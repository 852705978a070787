; 3:1 error[iso-code]
G91
G05 X10 Y5
M02
