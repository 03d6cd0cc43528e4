(* A function that does not fall on the way from a to x; what a square and a discriminant say. *)
Lemma rises : forall (f g : R -> R) a x,
  (forall u, Rmin a x <= u <= Rmax a x -> is_derive f u (g u) /\ 0 <= g u * (x - a)) -> f a <= f x.
Proof.
  intros f g a x H. destruct (MVT_gen f a x g) as [c [B E]].
  - intros u U. apply H. lra.
  - intros u U. apply derivable_continuous_pt. exists (g u). apply is_derive_Reals, H, U.
  - specialize (H c B). lra.
Qed.
Lemma squares_not_below : forall x y, 0 <= x * x + (- 1) * (y * y) -> 0 <= x -> 0 <= x + (- 1) * y.
Proof. intros. nra. Qed.
Lemma squares_above : forall x y, 0 < x * x + (- 1) * (y * y) -> 0 <= x -> 0 < x + (- 1) * y.
Proof. intros. nra. Qed.
Lemma quadratic_not_below : forall a b c x, 0 <= a -> (a = 0 -> 0 <= c) -> 0 <= 4 * a * c + (- 1) * (b * b) ->
  0 <= a * x * x + b * x + c.
Proof.
  intros a b c x [A | A] C D; assert (Q := pow2_ge_0 (2 * a * x + b)); [nra |].
  assert (b = 0) by (subst a; nra). specialize (C (eq_sym A)). subst. lra.
Qed.
Lemma quadratic_above : forall a b c x, 0 <= a -> (a = 0 -> 0 <= c) -> 0 < 4 * a * c + (- 1) * (b * b) ->
  0 < a * x * x + b * x + c.
Proof. intros a b c x [A | A] C D; assert (Q := pow2_ge_0 (2 * a * x + b)); [nra | subst a; nra]. Qed.
Ltac by_fraction Q :=
  match type of Q with _ ?y => match goal with |- _ ?x => replace x with y by (field; nonzero); exact Q end end.
