; 3:1 note[iso-end]
G91
G03 X-103 Y97 I-100 J0
M02
