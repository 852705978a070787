; Lines by point-by-point comparison [S]: F = 0 at the start; F >= 0: a step along x, F - |y|;
; F < 0: a step along y, F + |x|.
;
; F stays within +-999,999: 3 bytes. J is the longer of |x|, |y|, and y at a tie [D]: only so does the
; rule end on the end of the line. A line without x would step x first: there u is y, and F stays 0.

.scope
line:
        lda #0
        ldx #3
_clear: sta f,x
        sta less,x
        sta more,x
        dex
        bpl _clear
        ldx quadrant
        lda line_y-1,x
        ldy zero_x
        beq _along_u            ; no x: y is u
        ldx #2
        jsr aim
        ldx #2
_take:  lda y_um,x
        sta less,x
        lda x_um,x
        sta more,x
        dex
        bpl _take
        ldx quadrant
        lda line_x-1,x
        ldx #0
        jsr aim
        ldy #4                  ; where the bytes of y stand in the block
        lda y_um
        cmp x_um
        lda y_um+1
        sbc x_um+1
        lda y_um+2
        sbc x_um+2
        bcs _on_v               ; |y| >= |x|
        ldy #1
        bne _on_u
_along_u:
        ldx #0
        jsr aim
        ldy #4
_on_u:  jsr take_j
        jsr first_feed
        jmp line_u
_on_v:  jsr take_j
        jsr first_feed
        jmp line_v
.scend

; Directions of L1..L4.
line_x: .byte x_plus,x_minus,x_minus,x_plus
line_y: .byte y_plus,y_plus,y_minus,y_minus

; --- the loop that counts along u --------------------------------------------------------------
line_u_v:
        .invoke line_more
        .invoke step step_v, take_v
line_u: .invoke wait_feed
        lda f+2
        bmi line_u_v
        .invoke line_less
        sec
        .invoke count_down 1, line_u_aside
line_u_step:
        .invoke step step_u, take_u
        jmp line_u
line_u_aside:
        .invoke aside line_u_step, step_u, take_u

; --- the loop that counts along v --------------------------------------------------------------
line_v_v:
        .invoke line_more
        sec
        .invoke count_down 1, line_v_aside
line_v_step:
        .invoke step step_v, take_v
line_v: .invoke wait_feed
        lda f+2
        bmi line_v_v
        .invoke line_less
        .invoke step step_u, take_u
        jmp line_v
line_v_aside:
        .invoke aside line_v_step, step_v, take_v
