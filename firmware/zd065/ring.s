; The ring distributor and the play of the axes: software in place of hardware [S].
;
; A motor has three phases and six steps a ring, A, AB, B, BC, C, CA forwards [S]; the patterns of x
; and y stand side by side on one port. A table gives for each pattern of the port the next one, so
; that a step is one look-up:
;
;       lda (step_u),y      ; Y is what the port shows
;       sta motors
;       tay
;
; Patterns that no ring has (no phase, or all three) lead to A: a disturbed port comes back.
;
; Play: where an axis turns back, step_u leads to a table whose entries have bit 7 set. The loops see
; that at no more than a branch, take the play up first, and go on with the right table. It is the
; first step of the axis that does so, not the change of quadrant: an axis may end without one.

.alias x_plus      $00          ; low bytes of the addresses of the four tables: a direction
.alias x_minus     $40
.alias y_plus      $80          ; bit 7: along y
.alias y_minus     $C0

; The four tables, one page: entries 0..63, what PA0..PA5 show.
rings:
        ; x forwards
        .byte $01,$03,$06,$02,$05,$01,$04,$01,$09,$0B,$0E,$0A,$0D,$09,$0C,$09
        .byte $11,$13,$16,$12,$15,$11,$14,$11,$19,$1B,$1E,$1A,$1D,$19,$1C,$19
        .byte $21,$23,$26,$22,$25,$21,$24,$21,$29,$2B,$2E,$2A,$2D,$29,$2C,$29
        .byte $31,$33,$36,$32,$35,$31,$34,$31,$39,$3B,$3E,$3A,$3D,$39,$3C,$39
        ; x backwards
        .byte $01,$05,$03,$01,$06,$04,$02,$01,$09,$0D,$0B,$09,$0E,$0C,$0A,$09
        .byte $11,$15,$13,$11,$16,$14,$12,$11,$19,$1D,$1B,$19,$1E,$1C,$1A,$19
        .byte $21,$25,$23,$21,$26,$24,$22,$21,$29,$2D,$2B,$29,$2E,$2C,$2A,$29
        .byte $31,$35,$33,$31,$36,$34,$32,$31,$39,$3D,$3B,$39,$3E,$3C,$3A,$39
        ; y forwards
        .byte $08,$09,$0A,$0B,$0C,$0D,$0E,$0F,$18,$19,$1A,$1B,$1C,$1D,$1E,$1F
        .byte $30,$31,$32,$33,$34,$35,$36,$37,$10,$11,$12,$13,$14,$15,$16,$17
        .byte $28,$29,$2A,$2B,$2C,$2D,$2E,$2F,$08,$09,$0A,$0B,$0C,$0D,$0E,$0F
        .byte $20,$21,$22,$23,$24,$25,$26,$27,$08,$09,$0A,$0B,$0C,$0D,$0E,$0F
        ; y backwards
        .byte $08,$09,$0A,$0B,$0C,$0D,$0E,$0F,$28,$29,$2A,$2B,$2C,$2D,$2E,$2F
        .byte $18,$19,$1A,$1B,$1C,$1D,$1E,$1F,$08,$09,$0A,$0B,$0C,$0D,$0E,$0F
        .byte $30,$31,$32,$33,$34,$35,$36,$37,$20,$21,$22,$23,$24,$25,$26,$27
        .byte $10,$11,$12,$13,$14,$15,$16,$17,$08,$09,$0A,$0B,$0C,$0D,$0E,$0F
turned_back:
        .byte $80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80
        .byte $80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80
        .byte $80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80
        .byte $80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80,$80

; Make a step: pattern table _1, taker of play _2. Y is what the port shows, before and after.
.macro step
        lda (_1),y
        bpl _put
        jsr _2
_put:   sta motors
        tay
.macend

; Set the direction A of axis X (0 u, 2 v) of a block, or of a quadrant of an arc.
.scope
aim:
        sta ring_u,x
        cmp #y_plus
        bcs _along_y
        cmp last_x
        beq _goes_on
        bne _turns
_along_y:
        cmp last_y
        beq _goes_on
_turns: lda #<turned_back
        sta step_u,x
        lda #>turned_back
        sta step_u+1,x
        rts
_goes_on:
        sta step_u,x
        lda #>rings
        sta step_u+1,x
        rts
.scend

; Take up the play of u or v. Returns the pattern of the step after it in A; keeps X.
; These steps do not count in J [S]; no short circuit stops them, so they wait for no feed: they run
; at a pace of their own [R].
take_u:
        stx keep
        ldx #0
        beq take
take_v:
        stx keep
        ldx #2
.scope
take:
        lda ring_u,x
        sta step_u,x
        sta table
        lda #>rings
        sta step_u+1,x
        sta table+1
        lda ring_u,x
        bmi _along_y
        sta last_x
        lda play_x
        jmp _count
_along_y:
        sta last_y
        lda play_y
_count: sta pulses
        beq _taken
_pulse: lda (table),y
        sta motors
        tay
        jsr pause_step
        dec pulses
        bne _pulse
_taken: ldx keep
        lda (table),y
        rts
.scend

; Wait for `pace` ms at 1 MHz. Keeps Y.
.scope
pause_step:
        ldx pace
        beq _done
_ms:    lda #137                ; 137 times 7 cycles, and 41 around the first ms
_beat:  sec
        sbc #1
        bne _beat
        dex
        bne _ms
_done:  rts
.scend
