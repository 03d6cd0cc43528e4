(* Matrices of any size, whose equations are shown by multiplying out. *)
Definition mat (m n : nat) : Type := @matrix R m n.
Definition entry {m n} (A : mat m n) (i j : nat) : R := coeff_mat 0 A i j.
Definition zeros {m n} : mat m n := mk_matrix m n (fun _ _ => 0).
Definition unit {n} : mat n n := @Mone R_Ring n.
Definition times {m n k} (A : mat m n) (B : mat n k) : mat m k := @Mmult R_Ring m n k A B.
Definition add {m n} (A B : mat m n) : mat m n := @Mplus R_AbelianGroup m n A B.
Definition scale {m n} (c : R) (A : mat m n) : mat m n := mk_matrix m n (fun i j => c * entry A i j).
Definition turn {m n} (A : mat m n) : mat n m := mk_matrix n m (fun i j => entry A j i).
Definition number (A : mat 1 1) : R := entry A 0 0.
Infix "[*]" := times (at level 40, left associativity).
Infix "[.]" := scale (at level 40, left associativity).
Infix "[+]" := add (at level 50, left associativity).

Lemma by_entries : forall m n (A B : mat m n),
  (forall i j, (i < m)%nat -> (j < n)%nat -> entry A i j = entry B i j) -> A = B.
Proof. intros m n A B E. apply (coeff_mat_ext_aux 0 0). exact E. Qed.
Lemma entry_of : forall m n (u : nat -> nat -> R) i j, (i < m)%nat -> (j < n)%nat ->
  entry (mk_matrix m n u : mat m n) i j = u i j.
Proof. intros. now apply coeff_mat_bij. Qed.
Lemma entry_add : forall m n (A B : mat m n) i j, (i < m)%nat -> (j < n)%nat ->
  entry (A [+] B) i j = entry A i j + entry B i j.
Proof. intros. unfold add, Mplus. now rewrite entry_of. Qed.
Lemma entry_scale : forall m n c (A : mat m n) i j, (i < m)%nat -> (j < n)%nat ->
  entry (c [.] A) i j = c * entry A i j.
Proof. intros. unfold scale. now rewrite entry_of. Qed.
Lemma entry_turn : forall m n (A : mat m n) i j, (i < n)%nat -> (j < m)%nat -> entry (turn A) i j = entry A j i.
Proof. intros. unfold turn. now rewrite entry_of. Qed.
Lemma entry_zeros : forall m n i j, (i < m)%nat -> (j < n)%nat -> entry (@zeros m n) i j = 0.
Proof. intros. unfold zeros. now rewrite entry_of. Qed.
Lemma entry_times : forall m n k (A : mat m n) (B : mat n k) i j, (i < m)%nat -> (j < k)%nat ->
  entry (A [*] B) i j = sum_n (fun l => entry A i l * entry B l j) (pred n).
Proof. intros. unfold times, Mmult. now rewrite entry_of. Qed.
Lemma beyond_end : forall n (v : Tn n R) j, (n <= j)%nat -> coeff_Tn 0 v j = 0.
Proof.
  induction n as [|n IH]; intros v j H; [reflexivity |]. destruct j as [|j]; [inversion H |].
  exact (IH (snd v) j (le_S_n _ _ H)).
Qed.
Lemma no_column : forall m (A : mat m 0) i j, entry A i j = 0.
Proof. intros. exact (beyond_end 0 _ j (Nat.le_0_l j)). Qed.
Lemma no_row : forall n (A : mat 0 n) i j, entry A i j = 0.
Proof. intros m A i j. unfold entry, coeff_mat. simpl. generalize j. clear. induction m; intros [|j]; simpl; auto. Qed.
Ltac entries := apply by_entries; intros; repeat first
  [ rewrite entry_add by assumption | rewrite entry_scale by assumption | rewrite entry_zeros by assumption
  | rewrite entry_turn by assumption ].

(* Products are written from the right, sums and numbers outside. *)
Section Rules.
Context {m n k l : nat}.
Lemma from_right : forall (A : mat m n) (B : mat n k) (C : mat k l), A [*] B [*] C = A [*] (B [*] C).
Proof. intros. symmetry. exact (@Mmult_assoc R_Ring m n k l A B C). Qed.
Lemma times_add : forall (A : mat m n) (B C : mat n k), A [*] (B [+] C) = A [*] B [+] A [*] C.
Proof. exact (@Mmult_distr_l R_Ring m n k). Qed.
Lemma add_times : forall (A B : mat m n) (C : mat n k), (A [+] B) [*] C = A [*] C [+] B [*] C.
Proof. exact (@Mmult_distr_r R_Ring m n k). Qed.
Lemma times_unit : forall A : mat m n, A [*] unit = A.
Proof. exact (@Mmult_one_r R_Ring m n). Qed.
Lemma unit_times : forall A : mat m n, unit [*] A = A.
Proof. exact (@Mmult_one_l R_Ring m n). Qed.
Lemma scale_times : forall c (A : mat m n) (B : mat n k), (c [.] A) [*] B = c [.] (A [*] B).
Proof.
  intros. apply by_entries. intros i j I J. rewrite entry_scale, !entry_times by assumption.
  rewrite <- (sum_n_mult_l (K := R_Ring)). apply sum_n_m_ext_loc. intros p P. change mult with Rmult. simpl.
  destruct n; [rewrite !no_column; ring |].
  rewrite entry_scale; [ring | exact I |]. apply le_n_S. now destruct P.
Qed.
Lemma times_scale : forall c (A : mat m n) (B : mat n k), A [*] (c [.] B) = c [.] (A [*] B).
Proof.
  intros. apply by_entries. intros i j I J. rewrite entry_scale, !entry_times by assumption.
  rewrite <- (sum_n_mult_l (K := R_Ring)). apply sum_n_m_ext_loc. intros p P. change mult with Rmult. simpl.
  destruct n; [rewrite !no_column; ring |].
  rewrite entry_scale; [ring | | exact J]. apply le_n_S. now destruct P.
Qed.
Lemma scale_add : forall c (A B : mat m n), c [.] (A [+] B) = c [.] A [+] c [.] B.
Proof. intros. entries. ring. Qed.
Lemma scale_scale : forall c d (A : mat m n), c [.] (d [.] A) = (c * d) [.] A.
Proof. intros. entries. ring. Qed.
Lemma times_zeros : forall A : mat m n, A [*] (@zeros n k) = zeros.
Proof.
  intro A. replace (@zeros n k) with (0 [.] @zeros n k) by (entries; ring). rewrite times_scale. entries. ring.
Qed.
Lemma zeros_times : forall A : mat n k, (@zeros m n) [*] A = zeros.
Proof.
  intro A. replace (@zeros m n) with (0 [.] @zeros m n) by (entries; ring). rewrite scale_times. entries. ring.
Qed.
Lemma scale_zeros : forall c, c [.] (@zeros m n) = zeros.
Proof. intros. entries. ring. Qed.
Lemma turn_turn : forall A : mat m n, turn (turn A) = A.
Proof. intros. now entries. Qed.
Lemma turn_add : forall A B : mat m n, turn (A [+] B) = turn A [+] turn B.
Proof. intros. now entries. Qed.
Lemma turn_scale : forall c (A : mat m n), turn (c [.] A) = c [.] turn A.
Proof. intros. now entries. Qed.
Lemma turn_zeros : turn (@zeros m n) = zeros.
Proof. now entries. Qed.
Lemma turn_times : forall (A : mat m n) (B : mat n k), turn (A [*] B) = turn B [*] turn A.
Proof.
  intros. entries. rewrite !entry_times by assumption. apply sum_n_m_ext_loc. intros p P.
  destruct n; [change mult with Rmult; simpl; rewrite !no_column; ring |].
  rewrite !entry_turn by (assumption || (apply le_n_S; now destruct P)). apply Rmult_comm.
Qed.
Lemma turn_unit : turn (@unit n) = unit.
Proof.
  apply by_entries. intros i j I J. rewrite entry_turn by assumption. unfold entry, unit, Mone.
  rewrite !coeff_mat_bij by assumption. clear. revert j. induction i; destruct j; simpl; trivial.
Qed.
Lemma cut : forall (A : mat m 1) (B : mat 1 1), A [*] B = number B [.] A.
Proof.
  intros. apply by_entries. intros i j I J. rewrite entry_scale, entry_times by assumption. simpl.
  rewrite sum_O. destruct j; [apply Rmult_comm | apply le_S_n in J; inversion J].
Qed.
Lemma number_add : forall A B, number (A [+] B) = number A + number B.
Proof. intros. unfold number. now apply entry_add; apply le_n. Qed.
Lemma number_scale : forall c A, number (c [.] A) = c * number A.
Proof. intros. unfold number. now apply entry_scale; apply le_n. Qed.
Lemma by_difference_0 : forall A B : mat m n, A [+] (- 1) [.] B = zeros -> A = B.
Proof.
  intros A B H. apply by_entries. intros i j I J. apply (f_equal (fun M => entry M i j)) in H.
  rewrite entry_add, entry_scale, entry_zeros in H by assumption. lra.
Qed.
Lemma difference_0 : forall A B : mat m n, A = B -> A [+] (- 1) [.] B = zeros.
Proof. intros A B H. rewrite H. entries. ring. Qed.
End Rules.
(* The inverse of a matrix that is its own transposed is its own transposed. *)
Lemma turned_inverse : forall n (A X : mat n n), turn A = A -> A [*] X = unit -> X [*] A = unit -> turn X = X.
Proof.
  intros n A X S P Q. assert (T := f_equal turn P). rewrite turn_times, S, turn_unit in T.
  now rewrite <- (times_unit (turn X)), <- P, <- from_right, T, unit_times.
Qed.
Lemma named : forall m n (A : mat m n), exists B, B = A.
Proof. intros. now exists A. Qed.
Lemma same_inverse : forall n (A X Y : mat n n), A [*] X = unit -> Y [*] A = unit -> X = Y.
Proof. intros n A X Y P Q. now rewrite <- (unit_times X), <- Q, from_right, P, times_unit. Qed.
Ltac turned_back :=
  eapply same_inverse; [eassumption |]; rewrite <- turn_times;
  match goal with H : _ = unit |- _ => rewrite H; apply turn_unit end.
Ltac multiply_out := repeat first
  [ rewrite turn_times | rewrite turn_add | rewrite turn_scale | rewrite turn_unit | rewrite turn_zeros | rewrite turn_turn
  | match goal with S : turn ?A = _ |- context [turn ?A] => is_var A; rewrite S end
  | rewrite times_zeros | rewrite zeros_times | rewrite times_unit | rewrite unit_times | rewrite scale_zeros
  | rewrite times_add | rewrite add_times | rewrite scale_times | rewrite times_scale | rewrite scale_add
  | rewrite scale_scale | rewrite from_right | rewrite cut | rewrite number_add | rewrite number_scale ].
Ltac words := multiply_out; entries; first [ ring | field; nonzero ].
(* What is 0 by a hypothesis, or by its transposed. *)
Ltac related := match goal with H : @eq (mat _ _) ?a ?b |- _ => solve
  [ transitivity (a [+] (- 1) [.] b); [ words | exact (difference_0 a b H) ]
  | transitivity (turn (a [+] (- 1) [.] b)); [ words | rewrite (difference_0 a b H); apply turn_zeros ] ] end.
