; J counts down in decimal, as the display shows it [S]: every counted step takes 1.
;
; J is packed BCD all the way from the data to the display; no conversion is ever made. The low byte
; is counted in line; every hundredth step it borrows or may be the last, and goes aside.

; Count a step. _1 is 0 where carry is clear, 1 where it is set; _2 is where `aside` stands.
; Z and C of a decimal subtraction of 1 are right on every 6502: the result is 0 where the binary is.
.macro count_down
        sed
        lda j+2
        sbc #_1
        sta j+2
        cld
        beq _2
        bcc _2
.macend

; Aside, once in fifty counted steps: borrow, and go on at _1; or the last step: make it with table
; _2 and taker of play _3, and end the block.
.macro aside
        bcc _borrow
        lda j
        ora j+1
        bne _go_on
        .invoke step _2, _3
        jmp block_done
_borrow:
        jsr borrow
_go_on: jmp _1
.macend

borrow:
        sed
        sec
        lda j+1
        sbc #1
        sta j+1
        lda j
        sbc #0
        sta j
        cld
        rts
