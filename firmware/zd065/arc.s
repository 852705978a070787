; Arcs by point-by-point comparison [S]: F = x^2 + y^2 - R^2, 0 at the start.
;
; u is the magnitude that shrinks in this quadrant and sense, v the one that grows [S]:
;       F >= 0: u - 1, F - (2u - 1);    F < 0: v + 1, F + (2v + 1).
; less = 2u - 1 and more = 2v + 1 are kept, so a step is one addition and one count by 2. R goes up to
; 10,000,000 um, so F, less and more have 4 bytes; with 3 an arc goes wrong above R = 4,194,303 [M].
; On an axis (u = 0) the quadrant changes: u and v change places, F carries on [S].
;
; J counts along the sides of the inscribed square [S]: while u > v steps along v, then steps along u.
; Each step, whichever it is, makes u - v smaller by 1 [D]. So the number of steps until |x| = |y| is
; known when a quadrant begins: a loop of its own counts them down in X, and none compares x and y. At
; |x| = |y| y steps count [R]: where v is y that step still belongs to the first loop.
;
; The loops of this file and of line.s stand so that none lies in two pages: a branch into another
; page takes a cycle more. The tests look.

.scope
arc:
        lda #0
        ldx #3
_clear: sta f,x
        dex
        bpl _clear
        ldx sector
        lda arc_u,x
        ldx #x_um
        ldy #y_um
        cmp #y_plus
        bcc _odd
        ldx #y_um
        ldy #x_um
_odd:   sty keep
        ; less = 2u - 1, u > 0
        lda $00,x
        asl
        sta less
        lda $01,x
        rol
        sta less+1
        lda $02,x
        rol
        sta less+2
        lda #0
        rol
        sta less+3
        jsr less_by_1
        ; more = 2v + 1
        ldx keep
        sec
        lda $00,x
        rol
        sta more
        lda $01,x
        rol
        sta more+1
        lda $02,x
        rol
        sta more+2
        lda #0
        rol
        sta more+3
        ldy #9
        jsr take_j
        jsr first_feed
        jmp arc_resumed
.scend

; The next quadrant: u' = v, v' = 0.
.scope
next_quadrant:
        sec
        lda more
        sbc #2
        sta less
        ldx #0
_copy:  lda more+1,x
        sbc #0
        sta less+1,x
        lda #0
        sta more+1,x
        inx
        txa
        eor #3                  ; leaves C alone
        bne _copy
        lda #1
        sta more
        ldx sector
        lda arc_next,x
        sta sector
.scend

; Go on in a quadrant, from less, more, F, J and sector; a saved state is taken up again here.
; The steps of the first loop are u - v, and 1 more where v is y; twice that less 2 is
; less - more, and 2 more where v is y.
.scope
arc_resumed:
        jsr aim_arc
        sec
        lda less
        sbc more
        sta half
        lda less+1
        sbc more+1
        sta half+1
        lda less+2
        sbc more+2
        sta half+2
        lda less+3
        sbc more+3
        sta half+3
        ldx sector
        lda arc_u,x
        bmi _is_y
        clc                     ; u is x, v is y
        lda half
        adc #2
        sta half
        bcc _is_y
        inc half+1
        bne _is_y
        inc half+2
        bne _is_y
        inc half+3
_is_y:  lda half+3
        bpl _first
        jmp arc_after           ; no step is left
_first: lsr
        lda half+2
        ror
        sta left+1
        lda half+1
        ror
        sta left
        lda half
        ror
        tax
        inx                     ; 0 stands for 256
        jmp arc_before
.scend

; Set the directions of the sector.
aim_arc:
        ldx sector
        lda arc_u,x
        ldx #0
        jsr aim
        ldx sector
        lda arc_v,x
        ldx #2
        jmp aim

.scope
less_by_1:
        lda less
        bne _low
        lda less+1
        bne _middle
        lda less+2
        bne _high
        dec less+3
_high:  dec less+2
_middle:
        dec less+1
_low:   dec less
        rts
.scend

; --- until |x| = |y|: steps along v count ------------------------------------------------------
before_v:
        .invoke arc_more
        bcs before_v_carry
before_v_count:                 ; C is 0
        .invoke count_down 0, before_v_aside
before_v_step:
        .invoke step step_v, take_v
        dex
        beq before_high
arc_before:
        .invoke wait_feed
        lda f+3
        bmi before_v
        .invoke arc_less
        bcc before_u_borrow
before_u_step:
        .invoke step step_u, take_u
        dex
        bne arc_before
.scope
before_high:
        lda left
        bne _low
        lda left+1
        beq arc_after
        dec left+1
_low:   dec left
        jmp arc_before
.scend

before_v_carry:
        jsr more_carry
        jmp before_v_count
before_v_aside:
        .invoke aside before_v_step, step_v, take_v
before_u_borrow:                ; u = 0 this early: R^2 = 2
        jsr less_borrow
        bpl before_u_step
        .invoke step step_u, take_u
        jmp next_quadrant

; --- from |x| = |y| on: steps along u count ----------------------------------------------------
after_v:
        .invoke arc_more
        bcs after_v_carry
after_v_step:
        .invoke step step_v, take_v
arc_after:
        .invoke wait_feed
        lda f+3
        bmi after_v
        .invoke arc_less
        bcc after_u_borrow      ; C is 1
        .invoke count_down 1, after_u_aside
after_u_step:
        .invoke step step_u, take_u
        jmp arc_after

after_v_carry:
        jsr more_carry
        jmp after_v_step
after_u_aside:
        .invoke aside after_u_step, step_u, take_u
.scope
after_u_borrow:
        jsr less_borrow
        bmi _axis
        sec
        .invoke count_down 1, after_u_aside
        jmp after_u_step
_axis:  sec                     ; u = 0: the last step of this quadrant
        .invoke count_down 1, axis_aside
.scend
axis_step:
        .invoke step step_u, take_u
        jmp next_quadrant
axis_aside:
        .invoke aside axis_step, step_u, take_u

; Every 128th step of an axis: carry and borrow of the counts by 2. less_borrow returns N where u = 0.
.scope
more_carry:
        inc more+1
        bne _done
        inc more+2
        bne _done
        inc more+3
_done:  clc
        rts
.scend
.scope
less_borrow:
        lda less+1
        bne _middle
        lda less+2
        bne _high
        dec less+3
_high:  dec less+2
_middle:
        dec less+1
        lda less+3
        rts
.scend

; NR1..NR4, SR1..SR4: direction of the steps at F >= 0, at F < 0, and the next sector.
arc_u:  .byte x_minus,y_minus,x_plus,y_plus,   y_minus,x_plus,y_plus,x_minus
arc_v:  .byte y_plus,x_minus,y_minus,x_plus,   x_plus,y_plus,x_minus,y_minus
arc_next:
        .byte 1,2,3,0,  7,4,5,6
