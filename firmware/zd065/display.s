; Six digits of the display: J, the block's number, or an error, lit one after the other.
;
; J counts down to 0, then the number of the next block shows until that makes its first step [S]. The
; display takes its digits straight from the bytes that the interpolator counts in: nothing is copied
; at a step. It runs by timer interrupt and makes no addition, so it may come in decimal mode.

; Which digit, 0 to 5, is in `digit`; the group of 3 bytes begins at `shown`, a multiple of 4.
.scope
show_digit:
        pha
        txa
        pha
        bit timer               ; reading it ends the interrupt
        lda #0
        sta digits              ; dark while the segments change
        lda digit
        lsr                     ; C: the lower half of the byte
        ora shown
        tax
        lda $00,x
        bcs _low
        lsr
        lsr
        lsr
        lsr
_low:   and #$0F
        tax
        lda shapes,x
        sta segments
        ldx digit
        lda places,x
        sta digits
        dex
        bpl _same
        ldx #5
_same:  stx digit
        pla
        tax
        pla
        rti
.scend

places: .byte $01,$02,$04,$08,$10,$20
; Segments a..g in bits 0..6, of 0..9, A, b, C, d, E, F.
shapes: .byte $3F,$06,$5B,$4F,$66,$6D,$7D,$07,$7F,$6F,$77,$7C,$39,$5E,$79,$71
