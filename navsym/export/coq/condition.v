Require Import ZArith List Bool.
Import ListNotations.

(* A row of whole numbers times a vector, the squares of all rows of a matrix, and a sum of squares with weights. *)
Fixpoint dot (row : list Z) (x : list R) : R :=
  match row, x with a :: row, u :: x => IZR a * u + dot row x | _, _ => 0 end.
Fixpoint seen (matrix : list (list Z)) (x : list R) : R :=
  match matrix with row :: matrix => dot row x ^ 2 + seen matrix x | [] => 0 end.
Fixpoint size (weights : list Z) (x : list R) : R :=
  match weights, x with w :: weights, u :: x => IZR w * u ^ 2 + size weights x | _, _ => 0 end.

(* A quadratic form: for each variable its square and its products with those that follow. *)
Fixpoint form (q : list (Z * list Z)) (x : list R) : R :=
  match q, x with (d, row) :: q, u :: x => IZR d * u ^ 2 + 2 * u * dot row x + form q x | _, _ => 0 end.
Definition first (q : list (Z * list Z)) : Z * list Z := hd (0%Z, []) q.
Fixpoint add_row (c : Z) (row other : list Z) : list Z :=
  match row with a :: row => (hd 0 other + c * a)%Z :: add_row c row (tl other) | [] => other end.
Fixpoint add_square (c : Z) (row : list Z) (q : list (Z * list Z)) : list (Z * list Z) :=
  match row with
  | a :: row => ((fst (first q) + c * (a * a))%Z, add_row (c * a) row (snd (first q))) :: add_square c row (tl q)
  | [] => q
  end.
Fixpoint add_squares (c : Z) (matrix : list (list Z)) (q : list (Z * list Z)) : list (Z * list Z) :=
  match matrix with row :: matrix => add_squares c matrix (add_square c row q) | [] => q end.
Definition diagonal (c : Z) (weights : list Z) : list (Z * list Z) := map (fun w => ((c * w)%Z, [])) weights.

(* The square of each variable outweighs its products. *)
Fixpoint total (row : list Z) : Z := match row with e :: row => (Z.abs e + total row)%Z | [] => 0%Z end.
Fixpoint reduce (row : list Z) (q : list (Z * list Z)) : list (Z * list Z) :=
  match row with
  | e :: row => ((fst (first q) - Z.abs e)%Z, snd (first q)) :: reduce row (tl q)
  | [] => q
  end.
Fixpoint outweighs (n : nat) (q : list (Z * list Z)) : bool :=
  match n, q with
  | S n, (d, row) :: q => (total row <=? d)%Z && outweighs n (reduce row q)
  | _, [] => true
  | _, _ => false
  end.

Lemma dot_split : forall row u x, dot row (u :: x) = IZR (hd 0%Z row) * u + dot (tl row) x.
Proof. destruct row; intros; simpl; ring. Qed.
Lemma dot_nil : forall row, dot row [] = 0.
Proof. destruct row; reflexivity. Qed.
Lemma form_split : forall q u x,
  form q (u :: x) = IZR (fst (first q)) * u ^ 2 + 2 * u * dot (snd (first q)) x + form (tl q) x.
Proof. destruct q as [|[d row] q]; intros; simpl; ring. Qed.
Lemma form_nil : forall q, form q [] = 0.
Proof. destruct q as [|[d row] q]; reflexivity. Qed.
Lemma dot_add_row : forall c row other x, dot (add_row c row other) x = dot other x + IZR c * dot row x.
Proof.
  induction row as [|a row IH]; intros other x; [simpl; ring |].
  destruct x as [|u x]; [rewrite !dot_nil; ring |].
  simpl add_row. rewrite (dot_split other). simpl. rewrite IH, plus_IZR, mult_IZR. ring.
Qed.
Lemma form_add_square : forall c row q x, form (add_square c row q) x = form q x + IZR c * dot row x ^ 2.
Proof.
  induction row as [|a row IH]; intros q x; [simpl; ring |].
  destruct x as [|u x]; [rewrite !form_nil, dot_nil; ring |].
  simpl add_square. rewrite (form_split q). simpl. rewrite IH, dot_add_row, plus_IZR, !mult_IZR. ring.
Qed.
Lemma form_add_squares : forall c matrix q x, form (add_squares c matrix q) x = form q x + IZR c * seen matrix x.
Proof.
  induction matrix as [|row matrix IH]; intros; simpl; [ring |]. rewrite IH, form_add_square. ring.
Qed.
Lemma form_diagonal : forall c weights x, form (diagonal c weights) x = IZR c * size weights x.
Proof.
  induction weights as [|w weights IH]; intros x; destruct x as [|u x]; simpl; try ring.
  fold (diagonal c weights). rewrite IH, mult_IZR. destruct x; simpl; ring.
Qed.
Lemma form_reduce : forall row q u x,
  form (reduce row q) x - IZR (total row) * u ^ 2 <= form q x + 2 * u * dot row x.
Proof.
  induction row as [|e row IH]; intros q u x; [simpl; lra |].
  destruct x as [|v x].
  - rewrite !form_nil, dot_nil. assert (0 <= total (e :: row))%Z.
    { clear. induction (e :: row) as [|f l L]; simpl; [easy |]. apply Z.add_nonneg_nonneg; [apply Z.abs_nonneg | easy]. }
    apply IZR_le in H. assert (P := pow2_ge_0 u). nra.
  - simpl reduce. rewrite (form_split q). simpl total. simpl form. simpl dot.
    specialize (IH (tl q) u x). rewrite minus_IZR, plus_IZR, abs_IZR.
    assert (P := pow2_ge_0 (u + v)). assert (Q := pow2_ge_0 (u - v)).
    unfold Rabs. destruct (Rcase_abs (IZR e)); nra.
Qed.
Lemma form_positive : forall n q x, outweighs n q = true -> 0 <= form q x.
Proof.
  induction n as [|n IH]; intros [|[d row] q] x H; try discriminate; try (simpl; lra).
  simpl in H. apply andb_prop in H as [H1 H2]. apply Z.leb_le, IZR_le in H1.
  destruct x as [|u x]; [simpl; lra |]. simpl form.
  assert (A := form_reduce row q u x). assert (B := IH _ x H2). assert (P := pow2_ge_0 u). nra.
Qed.

(* c |N x|^2 + d size x is not negative: s times it less some squares has squares that outweigh all products. *)
Definition shown (matrix : list (list Z)) (weights : list Z) (c d s : Z) (squares : list (list Z)) : bool :=
  (0 <? s)%Z && outweighs (length weights)
    (add_squares (-1) squares (add_squares (s * c) matrix (diagonal (s * d) weights))).
Lemma seen_positive : forall matrix x, 0 <= seen matrix x.
Proof. induction matrix; intros; simpl; [lra | assert (P := pow2_ge_0 (dot a x)); specialize (IHmatrix x); lra]. Qed.
Lemma bound_of_squares : forall matrix weights c d s squares x, shown matrix weights c d s squares = true ->
  0 <= IZR c * seen matrix x + IZR d * size weights x.
Proof.
  unfold shown. intros matrix weights c d s squares x H. apply andb_prop in H as [S H].
  apply Z.ltb_lt, IZR_lt in S. apply (form_positive _ _ x) in H.
  rewrite !form_add_squares, form_diagonal, !mult_IZR in H. assert (P := seen_positive squares x). nra.
Qed.

(* The quotient of the largest and the smallest |N x| / |x| lies between two numbers, above one or below one. *)
Definition regular (matrix : list (list Z)) (weights : list Z) : Prop :=
  forall x, length x = length weights -> Exists (fun u => u <> 0) x -> 0 < seen matrix x.
Definition at_least matrix weights (q : R) : Prop :=
  exists x y, 0 < size weights x /\ 0 < size weights y /\
    q ^ 2 * (seen matrix y * size weights x) <= seen matrix x * size weights y.
Definition at_most matrix weights (q : R) : Prop :=
  forall x y, seen matrix x * size weights y <= q ^ 2 * (seen matrix y * size weights x).

Fixpoint whole_dot (row x : list Z) : Z :=
  match row, x with a :: row, u :: x => (a * u + whole_dot row x)%Z | _, _ => 0%Z end.
Fixpoint whole_seen (matrix : list (list Z)) (x : list Z) : Z :=
  match matrix with row :: matrix => (whole_dot row x * whole_dot row x + whole_seen matrix x)%Z | [] => 0%Z end.
Fixpoint whole_size (weights x : list Z) : Z :=
  match weights, x with w :: weights, u :: x => (w * (u * u) + whole_size weights x)%Z | _, _ => 0%Z end.
Lemma dot_whole : forall row x, dot row (map IZR x) = IZR (whole_dot row x).
Proof. induction row; destruct x; simpl; try reflexivity. now rewrite IHrow, plus_IZR, mult_IZR. Qed.
Lemma seen_whole : forall matrix x, seen matrix (map IZR x) = IZR (whole_seen matrix x).
Proof. induction matrix; intros; simpl; [reflexivity |]. rewrite IHmatrix, dot_whole, plus_IZR, mult_IZR. ring. Qed.
Lemma size_whole : forall weights x, size weights (map IZR x) = IZR (whole_size weights x).
Proof. induction weights; destruct x; simpl; try reflexivity. rewrite IHweights, plus_IZR, !mult_IZR. ring. Qed.

Lemma size_nonnegative : forall weights x, forallb (Z.ltb 0) weights = true -> 0 <= size weights x.
Proof.
  induction weights as [|w weights IH]; intros [|u x] H; simpl; try lra. simpl in H.
  apply andb_prop in H as [W H]. apply Z.ltb_lt, IZR_lt in W. specialize (IH x H). assert (P := pow2_ge_0 u). nra.
Qed.
Lemma size_positive : forall weights x, forallb (Z.ltb 0) weights = true -> length x = length weights ->
  Exists (fun u => u <> 0) x -> 0 < size weights x.
Proof.
  induction weights as [|w weights IH]; intros [|u x] H L E; simpl in *; try discriminate; [inversion E |].
  apply andb_prop in H as [W H]. apply Z.ltb_lt, IZR_lt in W. assert (P := pow2_ge_0 u).
  assert (N := size_nonnegative weights x H). inversion E as [? ? U | ? ? U]; subst.
  - assert (0 < u ^ 2) by (destruct (Rdichotomy u 0 U); nra). nra.
  - specialize (IH x H ltac:(congruence) U). nra.
Qed.

(* a |N x|^2 <= b size x and c |N x|^2 >= d size x for all x; the quotient is at most p/q. *)
Definition enclosed matrix weights (a b c d s t : Z) above below : bool :=
  forallb (Z.ltb 0) [a; b; c; d] && forallb (Z.ltb 0) weights &&
  shown matrix weights (- a) b s above && shown matrix weights c (- d) t below.
Lemma bounds_of_squares : forall matrix weights a b c d s t above below,
  enclosed matrix weights a b c d s t above below = true ->
  regular matrix weights /\ 0 < IZR a * IZR d /\ (forall x, 0 <= size weights x) /\
  forall x y, IZR (a * d) * (seen matrix x * size weights y) <= IZR (b * c) * (seen matrix y * size weights x).
Proof.
  unfold enclosed. intros * H. apply andb_prop in H as [H D]. apply andb_prop in H as [H U]. apply andb_prop in H as [H W].
  rewrite forallb_forall in H. assert (P : forall e, In e [a; b; c; d] -> 0 < IZR e).
  { intros e I. apply IZR_lt, Z.ltb_lt, H, I. }
  simpl in P. assert (A := P a ltac:(tauto)). assert (B := P b ltac:(tauto)). assert (C := P c ltac:(tauto)).
  assert (E := P d ltac:(tauto)). clear P H.
  assert (Up : forall x, IZR a * seen matrix x <= IZR b * size weights x).
  { intro x. assert (G := bound_of_squares _ _ _ _ _ _ x U). rewrite opp_IZR in G. lra. }
  assert (Down : forall x, IZR d * size weights x <= IZR c * seen matrix x).
  { intro x. assert (G := bound_of_squares _ _ _ _ _ _ x D). rewrite opp_IZR in G. lra. }
  repeat split; [| nra | intro; now apply size_nonnegative |].
  - intros x L N. assert (S := size_positive weights x W L N). specialize (Down x). nra.
  - intros x y. rewrite !mult_IZR. assert (S := size_nonnegative weights x W).
    apply Rle_trans with (IZR a * seen matrix x * (IZR c * seen matrix y)).
    + replace (IZR a * IZR d * (seen matrix x * size weights y))
        with (IZR a * seen matrix x * (IZR d * size weights y)) by ring.
      apply Rmult_le_compat_l; [apply Rmult_le_pos; [lra | apply seen_positive] | apply Down].
    + replace (IZR b * IZR c * (seen matrix y * size weights x))
        with (IZR b * size weights x * (IZR c * seen matrix y)) by ring.
      apply Rmult_le_compat_r; [apply Rmult_le_pos; [lra | apply seen_positive] | apply Up].
Qed.

(* The bound p/q by whole numbers, with vectors x, y at which a quotient is reached. *)
Definition is_at_most matrix weights p q a b c d s t above below : bool :=
  (0 <? q)%Z && (b * c * (q * q) <=? p * p * (a * d))%Z && enclosed matrix weights a b c d s t above below.
Lemma show_at_most : forall matrix weights p q a b c d s t above below,
  is_at_most matrix weights p q a b c d s t above below = true ->
  regular matrix weights /\ at_most matrix weights (IZR p / IZR q).
Proof.
  unfold is_at_most. intros * H. apply andb_prop in H as [H E]. apply andb_prop in H as [Q F].
  apply Z.ltb_lt, IZR_lt in Q. apply Z.leb_le, IZR_le in F. rewrite !mult_IZR in F.
  apply bounds_of_squares in E as (G & A & S & E). split; [exact G |].
  intros x y. specialize (E x y). rewrite !mult_IZR in E. assert (T := seen_positive matrix y). specialize (S x).
  assert (V : 0 <= seen matrix y * size weights x) by (apply Rmult_le_pos; assumption).
  apply Rmult_le_reg_l with (IZR a * IZR d * (IZR q * IZR q)); [apply Rmult_lt_0_compat; [assumption | nra] |].
  replace (IZR a * IZR d * (IZR q * IZR q) * ((IZR p / IZR q) ^ 2 * (seen matrix y * size weights x)))
    with (IZR p * IZR p * (IZR a * IZR d) * (seen matrix y * size weights x)) by (field; lra).
  apply Rle_trans with (IZR b * IZR c * (IZR q * IZR q) * (seen matrix y * size weights x)).
  - assert (0 < IZR q * IZR q) by nra. nra.
  - apply Rmult_le_compat_r; assumption.
Qed.
Definition is_at_least matrix weights p q x y : bool :=
  (0 <? q)%Z && (0 <? whole_size weights x)%Z && (0 <? whole_size weights y)%Z &&
  (p * p * (whole_seen matrix y * whole_size weights x) <=? q * q * (whole_seen matrix x * whole_size weights y))%Z.
Lemma show_at_least : forall matrix weights p q x y,
  is_at_least matrix weights p q x y = true -> at_least matrix weights (IZR p / IZR q).
Proof.
  unfold is_at_least. intros * H. rewrite !andb_true_iff in H. destruct H as [[[Q X] Y] F].
  apply Z.ltb_lt, IZR_lt in Q, X, Y. apply Z.leb_le, IZR_le in F. rewrite !mult_IZR in F.
  exists (map IZR x), (map IZR y). rewrite !size_whole, !seen_whole. repeat split; try assumption.
  apply Rmult_le_reg_l with (IZR q * IZR q); [apply Rmult_lt_0_compat; assumption |].
  replace (IZR q * IZR q * ((IZR p / IZR q) ^ 2 * (IZR (whole_seen matrix y) * IZR (whole_size weights x))))
    with (IZR p * IZR p * (IZR (whole_seen matrix y) * IZR (whole_size weights x))) by (field; lra).
  exact F.
Qed.
Definition within matrix weights (low high : R) : Prop :=
  regular matrix weights /\ at_least matrix weights low /\ at_most matrix weights high.
Definition beyond matrix weights (low high : R) : Prop := regular matrix weights /\
  ((exists q, q < low /\ at_most matrix weights q) \/ (exists q, high < q /\ at_least matrix weights q)).
(* Weights 1, and weights that give all columns of the matrix the same length. *)
Definition ones (matrix : list (list Z)) : list Z := map (fun _ => 1%Z) (hd [] matrix).
Fixpoint column_squares (matrix : list (list Z)) : list Z :=
  match matrix with row :: matrix => add_row 1 (map (fun e => e * e)%Z row) (column_squares matrix) | [] => [] end.
