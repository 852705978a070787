; From the bytes of a block to what the interpolators need; wrong instructions are repaired [S].
;
; Nothing moves while a block is decoded, so a block in error makes no step. x, y: packed BCD to 3
; bytes binary; J stays as it is. The quadrant in the instruction says the signs; on an axis the
; wrong neighbour becomes the one that the block enters [S]. Anything else is an error [R].

; Set `next` behind a block of A bytes. C = 1 where the block does not fit the data.
.scope
measure:
        clc
        adc at
        sta next
        lda at+1
        adc #0
        sta next+1
        cmp #>data_end
        bcc _fits
        bne _over
        lda next
        bne _over
_fits:  clc
        rts
_over:  sec
        rts
.scend

; C = 1 where one of the bytes Y, Y - 1 .. 1 of the block is no packed BCD.
.scope
check_digits:
        lda (at),y
        cmp #$A0
        bcs _bad
        and #$0F
        cmp #$0A
        bcs _bad
        dey
        bne check_digits
        clc
_bad:   rts
.scend

; Convert X bytes of BCD from byte Y of the block on: 3 bytes in `number_bin`, and Z = 1 where all are 0.
; At most 16,777,215.
.scope
convert:
        stx shift
        lda #0
        sta number_bin
        sta number_bin+1
        sta number_bin+2
_skip:  lda (at),y              ; zeros in front: most numbers are short
        bne _byte
        iny
        dec shift
        bne _skip
        rts
_byte:  lsr
        lsr
        lsr
        lsr
        jsr add_digit
        lda (at),y
        and #$0F
        jsr add_digit
        iny
        lda (at),y
        dec shift
        bne _byte
        lda #1
        rts
.scend

; number_bin = 10 number_bin + A.
.scope
add_digit:
        pha
        asl number_bin
        rol number_bin+1
        rol number_bin+2
        lda number_bin+1
        sta ten+1
        lda number_bin+2
        sta ten+2
        lda number_bin
        sta ten
        asl
        rol number_bin+1
        rol number_bin+2
        asl
        rol number_bin+1
        rol number_bin+2
        clc
        adc ten
        sta number_bin
        lda number_bin+1
        adc ten+1
        sta number_bin+1
        lda number_bin+2
        adc ten+2
        sta number_bin+2
        pla
        clc
        adc number_bin
        sta number_bin
        bcc _done
        inc number_bin+1
        bne _done
        inc number_bin+2
_done:  rts
.scend

; Convert x, X bytes from byte 1, and y, as many bytes behind it.
.scope
convert_both:
        stx bits
        ldy #1
        jsr convert
        sta zero_x
        ldx #2
_x:     lda number_bin,x
        sta x_um,x
        dex
        bpl _x
        ldy bits
        iny
        ldx bits
        jsr convert
        sta zero_y
        ldx #2
_y:     lda number_bin,x
        sta y_um,x
        dex
        bpl _y
        rts
.scend

; On an axis, enter the right quadrant. A: 0 for lines and counter-clockwise arcs, 4 for clockwise.
; Not both x and y are 0.
.scope
repair:
        clc
        adc quadrant
        tax
        lda zero_y
        beq _on_x
        lda zero_x
        bne _right              ; on no axis: any quadrant is right, it says the signs
        lda enters_from_y-1,x
        bne _compare
_on_x:  lda enters_from_x-1,x
_compare:
        cmp quadrant
        beq _right
        sta quadrant
        inc repaired
        clc
        adc group
        sta code
_right: rts
.scend

; Quadrants 1..4 as named, then as entered from the axis; the second four are clockwise.
enters_from_x:
        .byte 1,3,3,1,  4,2,2,4
enters_from_y:
        .byte 2,2,4,4,  1,1,3,3

; Take J from byte Y of the block on.
take_j:
        lda (at),y
        sta j
        iny
        lda (at),y
        sta j+1
        iny
        lda (at),y
        sta j+2
        rts
