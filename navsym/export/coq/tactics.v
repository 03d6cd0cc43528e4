Lemma by_zero : forall x y, x + (- 1) * y = 0 -> x = y.
Proof. intros. lra. Qed.
Lemma exp_not_0 : forall x, exp x <> 0.
Proof. intro x. assert (H := exp_pos x). lra. Qed.

(* What stands above a line is not 0 where the quotient is not 0, and no factor of a product is. *)
Ltac split_factors :=
  repeat match goal with
  | H : ?a / ?b <> 0 |- _ => lazymatch goal with
    | _ : a <> 0 |- _ => fail
    | _ => assert (a <> 0) by (let Z := fresh in intro Z; apply H; rewrite Z; unfold Rdiv; ring)
    end
  | H : ?a * ?b <> 0 |- _ => lazymatch goal with
    | _ : b <> 0 |- _ => fail
    | _ =>
        assert (a <> 0) by (let Z := fresh in intro Z; apply H; rewrite Z; ring);
        assert (b <> 0) by (let Z := fresh in intro Z; apply H; rewrite Z; ring)
    end
  end.

Ltac know_exponentials :=
  repeat match goal with |- context [exp ?x] => lazymatch goal with
    | _ : 0 < exp x |- _ => fail
    | _ => assert (0 < exp x) by apply exp_pos end end.

(* Products, powers and exponentials that are not 0, by hypotheses up to form, sign and a number. *)
Ltac nonzero :=
  repeat match goal with |- _ /\ _ => split end;
  repeat first
    [ assumption | lra | apply exp_not_0 | apply Rgt_not_eq, sqrt_lt_R0; first [ assumption | lra ] | apply Rmult_integral_contrapositive_currified | apply pow_nonzero
    | apply Rinv_neq_0_compat | apply Rgt_not_eq, sin_gt_0; lra | apply Rgt_not_eq, cos_gt_0; lra
    | apply Rlt_not_eq, sin_lt_0; lra | apply Rlt_not_eq, cos_lt_0; lra
    | match goal with H : ?d <> 0 |- ?e <> 0 =>
        let Z := fresh in intro Z; apply H;
        first [ lra | solve [ ring [Z] ] | solve [ rewrite Z; ring ]
              | solve [ replace d with e by field; lra ] | solve [ replace d with (- e) by field; lra ] ]
      end
    | match goal with H : ?d <> 0 |- ?e <> 0 =>
        let Z := fresh in intro Z; apply H; field_simplify_eq;
        [ transitivity e; [ solve [ ring ] | exact Z ] | repeat split; first [ assumption | lra ] .. ]
      end
    | match goal with H : 0 < ?d |- ?e <> 0 =>
        first [ solve [ replace e with d by field; lra ] | solve [ replace e with (- d) by field; lra ] ]
      end
    | know_exponentials; timeout 10 nra ].

(* Denominators that are equal as polynomials become the same one: fewer are cleared, or none. *)
Ltac same_denominators :=
  unfold Rdiv;
  repeat match goal with |- context [/ ?a] => match goal with |- context [/ ?b] =>
    lazymatch a with b => fail | _ => replace (/ b) with (/ a) by (f_equal; ring) end end end.

(* Sines and cosines of sums. *)
Ltac by_addition :=
  repeat first
    [ rewrite sin_plus | rewrite cos_plus | rewrite sin_neg | rewrite cos_neg | rewrite sin_0 | rewrite cos_0 ];
  ring.

Ltac by_multiplication := rewrite ?exp_plus, ?exp_Ropp, ?exp_0; field; nonzero.

(* sqrt (f f p q) = f * sqrt p * sqrt q, and sqrt x ^ 2 = x. *)
Ltac root_of last :=
  apply sqrt_lem_1; [ lra | repeat apply Rmult_le_pos; first [ apply sqrt_pos | lra ] | last ].
Ltac square_of_root := apply pow2_sqrt; first [ assumption | lra | timeout 10 nra | many_digits ].

(* The root z of a quotient x / y is w / y, where w w = x y: a rule without a quotient. *)
Lemma whole_root : forall x y z, y <> 0 -> z ^ 2 = x / y -> exists w, z = w / y /\ w ^ 2 = x * y.
Proof.
  intros x y z Y S. exists (z * y). split; [field; exact Y |].
  rewrite Rpow_mult_distr, S. field. exact Y.
Qed.
Ltac whole_roots := progress repeat match goal with S : sqrt ?q ^ 2 = ?x / ?y |- _ =>
    let E := fresh in let T := fresh in let w := fresh "w" in
    destruct (whole_root x y (sqrt q) ltac:(nonzero) S) as [w [E T]]; clear S; rewrite E in *; clear E; rename T into S
  end.

Lemma half_root : 1 / sqrt 2 = sqrt 2 / 2.
Proof.
  assert (S := sqrt_sqrt 2 ltac:(lra)). assert (P := sqrt_lt_R0 2 ltac:(lra)).
  apply Rmult_eq_reg_r with (sqrt 2); [| lra]. replace (1 / sqrt 2 * sqrt 2) with 1 by (field; lra). lra.
Qed.

(* Products, quotients and powers of what is positive; sines and cosines on half a turn. *)
Lemma square_positive : forall x, x <> 0 -> 0 < x ^ 2.
Proof. intros x H. assert (P := Rsqr_pos_lt x H). unfold Rsqr in P. simpl. lra. Qed.
Lemma above : forall x, 0 <= x -> x <> 0 -> 0 < x.
Proof. intros x [P | E] N; [ exact P | now rewrite E in N ]. Qed.
Lemma opposite_sine : forall x, (- 1) * sin x = sin (- x).
Proof. intro x. rewrite sin_neg. ring. Qed.
Lemma half_turn : forall x, (- 1) * sin x = sin (x + PI).
Proof. intro x. rewrite neg_sin. ring. Qed.
Lemma whole_turn : forall x, sin x = sin (x + 2 * PI).
Proof. intro x. rewrite <- (sin_period x 1). f_equal. simpl. ring. Qed.
Lemma abs_by_square : forall v u, v ^ 2 = u ^ 2 -> 0 <= v -> Rabs u = v.
Proof. intros v u S P. rewrite <- (Rabs_pos_eq v P). apply Rsqr_eq_abs_0. unfold Rsqr. simpl in S. lra. Qed.
Lemma sqrt_by_square : forall v u, v ^ 2 = u -> 0 <= v -> sqrt u = v.
Proof. intros v u S P. rewrite <- S. now apply sqrt_pow2. Qed.
Ltac reach := first [ assumption | lra | assert (A := PI2_3_2); assert (B := PI_4); first [ lra | few_digits | timeout 5 nra ] ].
Ltac in_half_turn rule := first [ apply rule; reach | rewrite whole_turn; apply rule; reach ].
Ltac positive :=
  first [ assumption | lazymatch goal with
  | |- 0 <= (- 1) * sin _ => first [ rewrite opposite_sine; apply sin_ge_0; reach | rewrite half_turn; in_half_turn sin_ge_0 ]
  | |- 0 < (- 1) * sin _ => first [ rewrite opposite_sine; apply sin_gt_0; reach | rewrite half_turn; in_half_turn sin_gt_0 ]
  | |- 0 <= sin _ => in_half_turn sin_ge_0
  | |- 0 < sin _ => in_half_turn sin_gt_0
  | |- 0 <= cos _ => apply cos_ge_0; reach
  | |- 0 < cos _ => apply cos_gt_0; reach
  | |- 0 <= _ * _ => apply Rmult_le_pos; positive
  | |- 0 < _ * _ => apply Rmult_lt_0_compat; positive
  | |- 0 <= ?a / ?b => apply (Rmult_le_pos a (/ b)); positive
  | |- 0 < ?a / ?b => apply (Rmult_lt_0_compat a (/ b)); positive
  | |- 0 <= / _ => apply Rlt_le; positive
  | |- 0 < / _ => apply Rinv_0_lt_compat; first [ solve [ positive ] | apply above; [ positive | solve [ nonzero ] ] ]
  | |- 0 <= _ ^ 2 => apply pow2_ge_0
  | |- 0 < _ ^ 2 => first [ apply square_positive; solve [ nonzero ] | apply pow_lt; positive ]
  | |- 0 <= _ ^ _ => apply pow_le; positive
  | |- 0 < _ ^ _ => apply pow_lt; positive
  end | reach ].

(* A symbol between a value and itself is that value. *)
Ltac put_values :=
  repeat match goal with A : ?a <= ?x, B : ?x <= ?a |- _ =>
    is_var x; assert (x = a) by exact (Rle_antisym _ _ B A); subst x end.

(* An inequality by that of the difference with 0. *)
Ltac by_difference prove :=
  match goal with
  | |- _ <> _ => apply Rminus_not_eq; first [ apply Rgt_not_eq; prove | apply Rlt_not_eq; prove ]
  | |- _ <= _ => apply Rminus_le; prove
  | |- _ < _ => apply Rminus_lt; prove
  | |- _ >= _ => apply Rle_ge, Rminus_le; prove
  | |- _ > _ => apply Rminus_lt; prove
  end.

Ltac by_roots :=
  repeat match goal with |- context [sqrt ?x] =>
    let S := fresh in assert (S := sqrt_sqrt x ltac:(first [ lra | nra ])); revert S; assert (S := sqrt_pos x); revert S;
    generalize (sqrt x)
  end; intros; timeout 10 nra.
(* A function by what it stands for. *)
Ltac by_meaning :=
  unfold tan, tanh, sinh, cosh; try reflexivity;
  match goal with |- context [exp (- ?x)] => replace (- x) with ((- 1) * x) by ring;
    assert (P := exp_pos x); assert (N := exp_pos ((- 1) * x)); try reflexivity; field; lra end.

(* A symbol between two numbers: the product of its distances from them is not negative. *)
Ltac by_distances :=
  repeat match goal with A : ?a <= ?x, B : ?x <= ?b |- _ => lazymatch goal with
    | _ : 0 <= (x - a) * (b - x) |- _ => fail
    | _ => assert (0 <= (x - a) * (b - x)) by (apply Rmult_le_pos; lra)
    end end; timeout 10 nra.
(* An inequality with absolute values, by the signs of their arguments. *)
Ltac by_signs := unfold Rabs; repeat match goal with |- context [Rcase_abs ?x] => destruct (Rcase_abs x) end; timeout 10 nra.
(* A bound of a cosine that is reached at a third or two thirds of half a turn. *)
Lemma cosine_falls : forall x y, 0 <= x -> x <= y -> y <= PI -> cos y <= cos x.
Proof. intros x y A L B. apply cos_decr_1; lra. Qed.
Ltac by_falling :=
  assert (P := PI_RGT_0);
  match goal with |- context [cos ?x] =>
    let reached a value := first
      [ let F := fresh in assert (F := cosine_falls x a ltac:(lra) ltac:(lra) ltac:(lra)); rewrite value in F; lra
      | let F := fresh in assert (F := cosine_falls a x ltac:(lra) ltac:(lra) ltac:(lra)); rewrite value in F; lra ]
    in first [ reached (PI / 3) cos_PI3 | reached (2 * (PI / 3)) cos_2PI3 ] end.

(* A relation of numbers. *)
Ltac numbers :=
  match goal with
  | |- exists k, _ = IZR k => eexists; reflexivity
  | |- _ => first [ lra | intro; lra | by_difference ltac:(few_digits) | by_difference ltac:(many_digits) ]
  end.

(* The conditions of H hold; then H itself is false. *)
Ltac discharge H :=
  repeat match type of H with ?A -> ?B =>
    let N := fresh in assert (N : A) by (clear H; numbers); specialize (H N); clear N
  end.
Ltac contradict H :=
  match type of H with
  | _ /\ _ => let K := fresh in destruct H as [K H]; first [ contradict K | contradict H ]
  | ?x = ?y => let D := fresh in assert (D : x <> y) by (clear H; numbers); exact (D H)
  | ?x <> ?y => apply H; field
  | ?x <= ?y => let D := fresh in assert (D : y < x) by (clear H; numbers); exact (Rlt_not_le _ _ D H)
  | ?x >= ?y => let D := fresh in assert (D : x < y) by (clear H; numbers); exact (Rlt_not_ge _ _ D H)
  | ?x < ?y => let D := fresh in assert (D : y <= x) by (clear H; numbers); exact (Rle_not_lt _ _ D H)
  | ?x > ?y => let D := fresh in assert (D : x <= y) by (clear H; numbers); exact (Rle_not_gt _ _ D H)
  end.
(* A logarithm by those of the factors. *)
Ltac by_logarithms :=
  apply exp_inv; rewrite ?exp_plus, ?exp_Ropp, ?exp_0; rewrite !exp_ln by positive; field; nonzero.
