(* A derivative is the one that auto_derive finds, where its conditions are met. *)
Require Ratan.
Global Instance UnaryDiff_asin : UnaryDiff' asin.
Proof.
  exists (fun x => 1 / sqrt (1 - x²)) (fun x => -1 < x < 1). intros x H.
  rewrite <- (derive_pt_asin x H). apply is_derive_Reals, (derive_pt_eq_1 _ _ _ _ eq_refl).
Defined.
Global Instance UnaryDiff_tan : UnaryDiff' tan.
Proof.
  exists (fun x => / cos x ^ 2) (fun x => cos x <> 0). intros x H. unfold tan. auto_derive; [exact H |].
  assert (S := sin2_cos2 x). unfold Rsqr in S.
  transitivity ((sin x * sin x + cos x * cos x) / cos x ^ 2); [| rewrite S]; field; exact H.
Defined.
Global Instance UnaryDiff_acos : UnaryDiff' acos.
Proof.
  exists (fun x => -1 / sqrt (1 - x²)) (fun x => -1 < x < 1). intros x H.
  rewrite <- (derive_pt_acos x H). apply is_derive_Reals, (derive_pt_eq_1 _ _ _ _ eq_refl).
Defined.
Ltac destruct_all := repeat match goal with H : _ /\ _ |- _ => destruct H end.
(* Inverses and square roots of what is positive are positive. *)
Ltac know_positive :=
  repeat match goal with
  | H : ?a > 0 |- _ => apply Rgt_lt in H
  | H : 0 < ?a |- _ => lazymatch goal with
    | _ : 0 < / a |- _ => fail
    | _ => assert (0 < / a) by exact (Rinv_0_lt_compat a H)
    end
  end.
Ltac side :=
  rewrite ?Rmult_0_l, ?Rplus_0_r;
  first
    [ exact I | assumption | lra | solve [ nonzero ]
    | match goal with H : 0 < ?d |- 0 < ?e => solve [ replace e with d by (field; nonzero); exact H ] end
    | match goal with H : ?d > 0 |- 0 < ?e => solve [ replace e with d by (field; nonzero); exact H ] end
    | know_positive; solve [ lra | timeout 10 nra ] | numbers ].
Ltac fold_powers :=
  repeat match goal with
  | |- context [?x * (?x * 1)] => change (x * (x * 1)) with (x ^ 2)
  | |- context [?x * ?x ^ 2] => change (x * x ^ 2) with (x ^ 3)
  | |- context [?x * ?x ^ 3] => change (x * x ^ 3) with (x ^ 4)
  end.
Ltac conditions := fold_powers; repeat match goal with |- _ /\ _ => split end; side.
Ltac derive :=
  unfold Rpower; auto_derive;
  [ conditions
  | rewrite ?Rmult_0_l, ?Rplus_0_r; fold_powers; unfold Rsqr, Rdiv; try reflexivity;
    first [ solve [ ring ] | solve [ field; nonzero ] ] ].
(* Coquelicot has a type of its own for the numbers of an integral. *)
Ltac as_real :=
  repeat match goal with |- context [@eq ?T ?a ?b] => lazymatch T with
    | R => fail
    | _ => change (@eq T a b) with (@eq R a b)
    end end.
Ltac real_equation := as_real; first [ solve [ ring ] | field; nonzero ].
Ltac has_slope := apply (ex_derive_continuous (V := R_NormedModule)); auto_derive; conditions.

(* What is positive, or not 0, is so nearby. *)
Lemma is_near_positive : forall (g : R -> R) (x : R), continuous g x -> 0 < g x -> locally x (fun u : R => 0 < g u).
Proof. intros g x C P. exact (C _ (open_gt 0 (g x) P)). Qed.
Lemma is_near_nonzero : forall (g : R -> R) (x : R), continuous g x -> g x <> 0 -> locally x (fun u : R => g u <> 0).
Proof. intros g x C P. exact (C _ (open_neq 0 (g x) P)). Qed.
Ltac near_positive g := apply (is_near_positive g); [ has_slope | side ].
Ltac near_nonzero g := apply (is_near_nonzero g); [ has_slope | side ].

(* Integrals by antiderivatives, and by their limits. *)
Lemma by_antiderivative : forall (F f : R -> R) (a b : R),
  (forall x, Rmin a b <= x <= Rmax a b -> is_derive F x (f x)) ->
  (forall x, Rmin a b <= x <= Rmax a b -> continuous f x) -> RInt f a b = F b - F a.
Proof. intros F f a b D C. exact (is_RInt_unique f a b _ (is_RInt_derive F f a b D C)). Qed.
Lemma by_limits : forall (F f : R -> R) A B (ProperA : ProperFilter' A) (ProperB : ProperFilter' B) (la lb : R),
  (forall x, is_derive F x (f x)) -> (forall x, continuous f x) ->
  filterlim F A (locally la) -> filterlim F B (locally lb) -> RInt_gen f A B = lb - la.
Proof.
  intros F f A B PA PB la lb D C LA LB. apply is_RInt_gen_unique.
  apply (is_RInt_gen_ext (Derive F) f).
  - apply filter_forall. intros [a b] x _. exact (is_derive_unique F x _ (D x)).
  - apply is_RInt_gen_Derive; try assumption; apply filter_forall; intros [a b] x _.
    + exists (f x). apply D.
    + apply (continuous_ext f); [intro y; symmetry; exact (is_derive_unique F y _ (D y)) | apply C].
Qed.
Lemma at_place : forall (F : R -> R) a, filterlim F (at_point a) (locally (F a)).
Proof. intros F a P H. unfold filtermap, at_point. exact (locally_singleton _ _ H). Qed.

(* The sum and the product of the f (low + i) from low to high, of which there are high - low + 1. *)
Fixpoint add_terms (f : R -> R) (low : R) (n : nat) : R :=
  match n with S n => add_terms f low n + f (low + INR n) | O => 0 end.
Fixpoint multiply_terms (f : R -> R) (low : R) (n : nat) : R :=
  match n with S n => multiply_terms f low n * f (low + INR n) | O => 1 end.
Definition sum_over (f : R -> R) (low high : R) : R := add_terms f low (Z.to_nat (Int_part (high - low + 1))).
Definition product_over (f : R -> R) (low high : R) : R := multiply_terms f low (Z.to_nat (Int_part (high - low + 1))).
Lemma count_terms : forall low high, (exists k : Z, high - low + 1 = IZR k) -> 0 <= high - low + 1 ->
  exists n : nat, Z.to_nat (Int_part (high - low + 1)) = n /\ high - low + 1 = INR n.
Proof.
  intros low high [k E] P. rewrite E in *. apply le_IZR in P. exists (Z.to_nat k).
  assert (I : IZR k = INR (Z.to_nat k)) by (rewrite INR_IZR_INZ, Z2Nat.id; [reflexivity | exact P]).
  split; [| exact I]. rewrite I, Int_part_INR. apply Nat2Z.id.
Qed.
Lemma by_sum : forall (G f : R -> R) low high, (exists k : Z, high - low + 1 = IZR k) -> 0 <= high - low + 1 ->
  (forall x, low <= x -> x <= high -> G (x + 1) = G x + f x) -> sum_over f low high = G (high + 1) - G low.
Proof.
  intros G f low high W P E. destruct (count_terms low high W P) as (n & N & C). unfold sum_over. rewrite N.
  replace (high + 1) with (low + INR n) by lra. assert (B : low + INR n <= high + 1) by lra. clear - E B.
  induction n as [|n IH]; [simpl; rewrite Rplus_0_r; ring |]. rewrite S_INR in *. simpl add_terms.
  assert (Q := pos_INR n). rewrite IH by lra. rewrite <- Rplus_assoc, E by lra. ring.
Qed.
Lemma by_product : forall (G f : R -> R) low high, (exists k : Z, high - low + 1 = IZR k) -> 0 <= high - low + 1 ->
  (forall x, low <= x -> x <= high -> G (x + 1) = G x * f x) -> G low <> 0 ->
  product_over f low high = G (high + 1) / G low.
Proof.
  intros G f low high W P E Z. destruct (count_terms low high W P) as (n & N & C). unfold product_over. rewrite N.
  replace (high + 1) with (low + INR n) by lra. assert (B : low + INR n <= high + 1) by lra. clear - E B Z.
  induction n as [|n IH]; [simpl; rewrite Rplus_0_r; field; exact Z |]. rewrite S_INR in *. simpl multiply_terms.
  assert (Q := pos_INR n). rewrite IH by lra. rewrite <- Rplus_assoc, E by lra. field. exact Z.
Qed.
Lemma whole_sum : forall x y, (exists k : Z, x = IZR k) -> (exists k : Z, y = IZR k) -> exists k : Z, x + y = IZR k.
Proof. intros x y [k K] [m M]. exists (k + m)%Z. now rewrite plus_IZR, K, M. Qed.
Lemma whole_difference : forall x y, (exists k : Z, x = IZR k) -> (exists k : Z, y = IZR k) -> exists k : Z, x - y = IZR k.
Proof. intros x y [k K] [m M]. exists (k - m)%Z. now rewrite minus_IZR, K, M. Qed.
Lemma whole_product : forall x y, (exists k : Z, x = IZR k) -> (exists k : Z, y = IZR k) -> exists k : Z, x * y = IZR k.
Proof. intros x y [k K] [m M]. exists (k * m)%Z. now rewrite mult_IZR, K, M. Qed.
Ltac whole := repeat first
  [ assumption | eexists; reflexivity | apply whole_difference | apply whole_sum | apply whole_product ].

(* Limits at infinity of sums and products of what has a limit. *)
Lemma limit_atan_p : is_lim atan p_infty (PI / 2).
Proof.
  apply is_lim_spec. intro eps. exists (tan (PI / 2 - Rmin (PI / 4) eps)).
  assert (P := PI_RGT_0). assert (E := cond_pos eps). assert (Q : 0 < Rmin (PI / 4) eps) by (apply Rmin_glb_lt; lra).
  assert (M := Rmin_l (PI / 4) eps). assert (N := Rmin_r (PI / 4) eps). intros x X.
  assert (B := atan_bound x). apply atan_increasing in X. rewrite atan_tan in X by lra.
  unfold Rabs. destruct (Rcase_abs (atan x - PI / 2)); lra.
Qed.
Lemma limit_atan_m : is_lim atan m_infty (- (PI / 2)).
Proof.
  apply is_lim_spec. intro eps. exists (- tan (PI / 2 - Rmin (PI / 4) eps)).
  assert (P := PI_RGT_0). assert (E := cond_pos eps). assert (Q : 0 < Rmin (PI / 4) eps) by (apply Rmin_glb_lt; lra).
  assert (M := Rmin_l (PI / 4) eps). assert (N := Rmin_r (PI / 4) eps). intros x X.
  assert (B := atan_bound x). rewrite <- tan_neg in X. apply atan_increasing in X. rewrite atan_tan in X by lra.
  unfold Rabs. destruct (Rcase_abs (atan x - - (PI / 2))); lra.
Qed.
Lemma limit_product : forall f g x (a b : R), is_lim f x a -> is_lim g x b -> is_lim (fun u => f u * g u) x (a * b).
Proof. intros f g x a b A B. apply (is_lim_mult f g x a b A B). exact I. Qed.
Lemma limit_line : forall g k, 0 < k -> (forall x, g x = g 0 - k * x) -> is_lim g p_infty m_infty.
Proof.
  intros g k K E. apply is_lim_spec. intro M. exists ((g 0 - M) / k). intros x X. rewrite (E x).
  apply (Rmult_lt_compat_l k) in X; [| exact K]. replace (k * ((g 0 - M) / k)) with (g 0 - M) in X by (field; lra). lra.
Qed.
(* What an exponential that falls outweighs: sums and products of numbers, of the variable, of sines and cosines. *)
Definition tempered (f : R -> R) : Prop := forall k, 0 < k -> is_lim (fun x => f x * exp (- (k * x))) p_infty 0.
Lemma tempered_id : tempered (fun x => x).
Proof.
  intros k K. apply (is_lim_ext (fun x => - (/ k) * ((- (k * x)) * exp (- (k * x))))); [intro; field; lra |].
  replace (Finite 0) with (Finite (- (/ k) * 0)) by (f_equal; ring). apply limit_product; [apply is_lim_const |].
  apply (is_lim_comp (fun y => y * exp y) (fun x => - (k * x)) p_infty 0 m_infty).
  - exact is_lim_mul_exp_m.
  - apply (limit_line (fun x => - (k * x)) k K). intro x. ring.
  - exists 0. intros x _. discriminate.
Qed.
Lemma tempered_bounded : forall f M, (forall x, - M <= f x <= M) -> tempered f.
Proof.
  intros f M B k K. assert (E : is_lim (fun x => exp (- (k * x))) p_infty 0).
  { apply (is_lim_comp exp (fun x => - (k * x)) p_infty 0 m_infty); [exact is_lim_exp_m | | exists 0; discriminate].
    apply (limit_line (fun x => - (k * x)) k K). intro x. ring. }
  apply (is_lim_le_le_loc (fun x => - M * exp (- (k * x))) (fun x => M * exp (- (k * x)))).
  - exists 0. intros x _. assert (P := exp_pos (- (k * x))). specialize (B x).
    split; apply Rmult_le_compat_r; lra.
  - replace (Finite 0) with (Finite (- M * 0)) by (f_equal; ring). apply limit_product; [apply is_lim_const | exact E].
  - replace (Finite 0) with (Finite (M * 0)) by (f_equal; ring). apply limit_product; [apply is_lim_const | exact E].
Qed.
Lemma tempered_number : forall c, tempered (fun _ => c).
Proof. intro c. apply (tempered_bounded _ (Rabs c)). intros _. unfold Rabs. destruct (Rcase_abs c); lra. Qed.
Lemma tempered_sum : forall f g, tempered f -> tempered g -> tempered (fun x => f x + g x).
Proof.
  intros f g F G k K. apply (is_lim_ext (fun x => f x * exp (- (k * x)) + g x * exp (- (k * x)))); [intro; ring |].
  replace (Finite 0) with (Finite (0 + 0)) by (f_equal; ring). apply is_lim_plus'; [exact (F k K) | exact (G k K)].
Qed.
Lemma tempered_product : forall f g, tempered f -> tempered g -> tempered (fun x => f x * g x).
Proof.
  intros f g F G k K.
  apply (is_lim_ext (fun x => f x * exp (- (k / 2 * x)) * (g x * exp (- (k / 2 * x))))).
  - intro x. replace (- (k * x)) with (- (k / 2 * x) + - (k / 2 * x)) by field. rewrite exp_plus. ring.
  - replace (Finite 0) with (Finite (0 * 0)) by (f_equal; ring). apply limit_product; [apply F | apply G]; lra.
Qed.
Lemma tempered_power : forall f n, tempered f -> tempered (fun x => f x ^ n).
Proof. intros f n F. induction n; [apply (tempered_number 1) | exact (tempered_product f _ F IHn)]. Qed.
Ltac tempered := repeat match goal with
  | |- tempered (fun x => ?c) => apply tempered_number
  | |- tempered (fun x => x) => apply tempered_id
  | |- tempered (fun x => sin _) => apply (tempered_bounded _ 1); intro; apply SIN_bound
  | |- tempered (fun x => cos _) => apply (tempered_bounded _ 1); intro; apply COS_bound
  | |- tempered (fun x => @?f x + @?g x) => apply (tempered_sum f g)
  | |- tempered (fun x => @?f x * @?g x) => apply (tempered_product f g)
  | |- tempered (fun x => @?f x ^ ?n) => apply (tempered_power f n)
  end.
Lemma limit_falls : forall f g k, tempered f -> 0 < k -> (forall x, g x = g 0 - k * x) ->
  is_lim (fun x => f x * exp (g x)) p_infty 0.
Proof.
  intros f g k F K E. apply (is_lim_ext (fun x => exp (g 0) * (f x * exp (- (k * x))))).
  - intro x. rewrite (E x). unfold Rminus. rewrite exp_plus. ring.
  - replace (Finite 0) with (Finite (exp (g 0) * 0)) by (f_equal; ring).
    apply limit_product; [apply is_lim_const | exact (F k K)].
Qed.
Ltac falls := match goal with |- is_lim (fun x => @?f x * exp (@?g x)) _ _ =>
    apply (limit_falls f g (g 0 - g 1)); [ tempered | side | intro; field; nonzero ] end.
Ltac limit :=
  first
    [ apply is_lim_const | falls
    | match goal with |- is_lim (fun x => exp (@?g x)) _ _ =>
        apply (is_lim_ext (fun x => 1 * exp (g x))); [ intro; ring | falls ] end
    | apply limit_atan_p | apply limit_atan_m
    | eapply is_lim_plus'; limit | eapply limit_product; limit ].
Ltac to_limit := match goal with |- filterlim ?F (Rbar_locally ?i) (locally ?l) => change (is_lim F i l); unfold Rdiv; limit end.
