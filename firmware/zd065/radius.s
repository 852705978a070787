; Is the radius of an arc within the limit of 10,000,000 um [S]? R^2 = x^2 + y^2 in 48 bits.

; Returns C = 1 where it is not. Below 7,000,000 um on both axes nothing has to be multiplied:
; R < 9,899,495 um.
.scope
radius_over:
        ldy #1
        lda (at),y
        cmp #$07
        bcs _large
        ldy #5
        lda (at),y
        cmp #$07
        bcs _large
        rts                     ; C is 0
_large: lda #0
        ldx #5
_clear: sta square,x
        dex
        bpl _clear
        ldx #x_um
        jsr add_square
        ldx #y_um
        jsr add_square
        ldx #0
        ldy #6
        sec                     ; the limit less R^2: borrows where R^2 is larger
_compare:
        lda largest,x
        sbc square,x
        inx
        dey
        bne _compare
        bcs _within
        sec
        rts
_within:
        clc
        rts
.scend

largest:                        ; 10,000,000 squared, low byte first
        .byte $00,$40,$7A,$10,$F3,$5A

; Add the square of the 3 bytes at zero page X to `square`: shift and add, 24 times.
.scope
add_square:
        lda $00,x
        sta factor
        sta bits
        lda $01,x
        sta factor+1
        sta bits+1
        lda $02,x
        sta factor+2
        sta bits+2
        lda #0
        sta factor+3
        sta factor+4
        sta factor+5
_bit:   lsr bits+2
        ror bits+1
        ror bits
        bcc _shift
        clc
        ldx #0
        ldy #6
_add:   lda square,x
        adc factor,x
        sta square,x
        inx
        dey
        bne _add
_shift: asl factor
        rol factor+1
        rol factor+2
        rol factor+3
        rol factor+4
        rol factor+5
        lda bits
        ora bits+1
        ora bits+2
        bne _bit
        rts
.scend
