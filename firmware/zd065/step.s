; What every loop of the interpolator is made of: the wait for the feed, and the two sides of F.
; In line, not subroutines: a call costs 12 cycles of about 90.

; The generator lets the machine step when the gap allows it [S]. One edge, one step [R].
.macro wait_feed
_wait:  bit flags
        bpl _wait
.macend

; F >= 0, of an arc: F - less, less - 2. C is 0 where the low byte borrowed.
.macro arc_less
        sec
        .invoke take_byte 0
        .invoke take_byte 1
        .invoke take_byte 2
        .invoke take_byte 3
        sec
        lda less
        sbc #2
        sta less
.macend

; F < 0, of an arc: F + more, more + 2. C is 1 where the low byte carries.
.macro arc_more
        clc
        .invoke add_byte 0
        .invoke add_byte 1
        .invoke add_byte 2
        .invoke add_byte 3
        clc
        lda more
        adc #2
        sta more
.macend

; F >= 0, of a line: F - |y|.
.macro line_less
        sec
        .invoke take_byte 0
        .invoke take_byte 1
        .invoke take_byte 2
.macend

; F < 0, of a line: F + |x|.
.macro line_more
        clc
        .invoke add_byte 0
        .invoke add_byte 1
        .invoke add_byte 2
.macend

.macro take_byte
        lda f+_1
        sbc less+_1
        sta f+_1
.macend

.macro add_byte
        lda f+_1
        adc more+_1
        sta f+_1
.macend
