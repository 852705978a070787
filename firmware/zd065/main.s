; The cutting program of the ZD-065: from data in memory to motor steps.
;
; Written from the paper (Sun Yat-sen University, 1983), and from nothing else of this project: that
; both make the same steps is the proof of both. Marks [S] [D] [R] [M] as in map.s.
; Assembled by Ophis: `ophis --no-branch-extend -o zd065.bin main.s`, one image for $E000..$FFFF.

.include "map.s"
.org rom
.include "ring.s"               ; first: its tables fill a page
.include "step.s"
.include "count.s"
.include "decode.s"
.include "radius.s"
.include "line.s"
.include "arc.s"
.include "display.s"

; --- switched on ------------------------------------------------------------------------------
.scope
reset:
        sei
        cld
        ldx #$FF
        txs
        lda #0
        tax
_clear: sta $00,x
        inx
        bne _clear
        sta generator           ; the generator is off
        lda #$01
        sta via1_ddrb
        lda #$09                ; both motors on phase A
        sta phases
        sta motors
        lda #$3F
        sta via1_ddra
        sta via2_ddrb
        lda #0
        sta via1_acr
        lda #$11                ; feed and key come as rising edges
        sta via1_pcr
        lda #$82                ; bit 7 of the flags is that of the feed
        sta via1_ier
        lda #$7F
        sta via2_ddra
        lda #$40                ; timer 1 runs on and on
        sta via2_acr
        lda #<scan_time
        sta timer
        lda #>scan_time
        sta timer_high
        lda #$C0
        sta via2_ier
        lda #1
        sta pace
        lda #y_plus             ; directions of the last approach: both positive [R]
        sta last_y
        lda #<data
        sta at
        lda #>data
        sta at+1
        lda #number
        sta shown
        cli
.scend

; The machine stands. Data, play and directions of approach are entered here.
stand:
        jsr wait_key
        lda entered
        bne next_block
        lda #no_play            ; without play entered the machine refuses to cut [S]
        jmp stop

; --- block by block ---------------------------------------------------------------------------
block_done:
        sty phases
        lda next
        sta at
        lda next+1
        sta at+1
.scope
next_block:
        lda #number
        sta shown
        lda at+1
        cmp #>data_end
        bcs _no_end
        ldy #0
        lda (at),y
        bne _block
        sta generator           ; A is 0: the generator is off
        lda #ended
        sta state
program_end:
        jmp program_end
_no_end:
        jsr count_block
        lda #no_end
        jmp stop

_block: sta code
        jsr count_block
        lda code
        cmp #thread_code
        beq _wait
        cmp #pause_code
        beq _wait
        and #$0F
        sta quadrant
        beq _none
        cmp #5
        bcs _none
        lda code
        and #$F0
        sta group
        beq _line
        cmp #move_code
        beq _line
        cmp #sr_code
        beq _arc
        cmp #nr_code
        beq _arc
_none:  lda #no_instruction
        jmp stop

; A thread point or a pause: the generator is off until the operator's key [R].
_wait:  lda #1
        jsr measure
        lda #waiting
        sta state
        lda #0
        sta generator
        jsr wait_key
        ldy phases
        jmp block_done

_line:  lda #7
        jsr measure
        bcs _no_end_2
        ldy #6
        jsr check_digits
        bcs _digit
        ldx #3
        jsr convert_both
        lda zero_x
        ora zero_y
        beq _no_step
        lda #0
        jsr repair
        jmp line

_arc:   lda #12
        jsr measure
        bcs _no_end_2
        ldy #11
        jsr check_digits
        bcs _digit
        ldy #1                  ; 11,000,000 and more may not fit 3 bytes
        lda (at),y
        cmp #$11
        bcs _large
        ldy #5
        lda (at),y
        cmp #$11
        bcs _large
        ldx #4
        jsr convert_both
        jsr radius_over
        bcs _large
        ldy #9
        jsr take_j
        lda j
        ora j+1
        ora j+2
        beq _no_step
        jsr within_two
        bcs _small
        lda #0
        ldx group
        cpx #nr_code
        beq _turn
        lda #4
_turn:  pha
        jsr repair
        pla
        clc
        adc quadrant
        sec
        sbc #1
        sta sector
        jmp arc

_no_end_2:
        lda #no_end
        bne stop
_digit: lda #bad_digit
        bne stop
_no_step:
        lda #no_step
        bne stop
_large: lda #too_large
        bne stop
_small: lda #too_small

.scend
; An error: A. Everything stands still; the display shows E, the error and the block.
stop:
        sta error
        ora #$E0
        sta message
        lda number+1
        sta message+1
        lda number+2
        sta message+2
        lda #message
        sta shown
        lda #0
        sta generator
        lda #stopped
        sta state
error_end:
        jmp error_end

; Wait until the key is pressed: a press from before does not count, nor does a feed edge.
wait_key:
        lda #key
        sta flags               ; writing a 1 puts a flag out
key_loop:
        lda flags
        and #key
        beq key_loop
        lda #feed
        sta flags
        rts

; The block's number, in decimal.
count_block:
        sed
        sec
        lda number+2
        adc #0
        sta number+2
        lda number+1
        adc #0
        sta number+1
        cld
        rts

; C = 1 where x + y < 2, that is R^2 < 2.
.scope
within_two:
        lda x_um
        ora y_um
        cmp #2
        bcs _no
        lda x_um
        and y_um
        ora x_um+1
        ora x_um+2
        ora y_um+1
        ora y_um+2
        bne _no
        sec
        rts
_no:    clc
        rts
.scend

; The first feed of a block. The generator cuts, or not; the display changes over to J.
.scope
first_feed:
        lda group
        cmp #move_code
        beq _off
        lda #cutting
        sta state
        lda #1
        bne _set
_off:   lda #moving
        sta state
        lda #0
_set:   sta generator
        ldy phases
        .invoke wait_feed
        lda #j
        sta shown
        rts
.scend

power_down:
        rti
code_end:

.advance $FFFA
        .word power_down,reset,show_digit
