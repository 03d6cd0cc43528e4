(* Exact algebra: quotients of polynomials and the normal form. Section 3 of docs/certificates.md. *)

open Text
open Tree

(* Monomials: numbers of atoms, rising, with exponents that are not 0 *)

module Monomial = struct
  type t = (int * Q.t) list

  let rec compare a b =
    match (a, b) with
    | [], [] -> 0
    | [], _ -> -1
    | _, [] -> 1
    | (i, p) :: a, (j, q) :: b ->
        if i <> j then Int.compare i j else let c = Q.compare p q in if c <> 0 then c else compare a b
end

module Terms = Map.Make (Monomial)

type form = Q.t Terms.t
type key = (Monomial.t * Q.t) list

(* [Part] is a generator of the quotients: a tree that is taken as it is. *)
type atom =
  | Circle
  | Symbol of string
  | Log of key
  | Asin of key
  | Acos of key
  | Atan of key
  | Erf of key
  | Atan2 of key * key
  | Exp of Monomial.t
  | Cis of Monomial.t
  | Root of key
  | Part of tree

module Table = Hashtbl.Make (struct
  type t = atom

  let equal a b = compare a b = 0
  let hash = Hashtbl.hash_param 100 300
end)

(* An atom is numbered when it is first met, so its number is above those of all atoms inside it. *)
let numbers : int Table.t = Table.create 64
let atoms : (int, atom) Hashtbl.t = Hashtbl.create 64

let intern atom =
  match Table.find_opt numbers atom with
  | Some i -> i
  | None ->
      let i = Hashtbl.length atoms in
      Table.replace numbers atom i;
      Hashtbl.replace atoms i atom;
      i

(* Work *)

exception Too_much

let left = ref 0 (* units of work that are still allowed *)
let most_work = 1_000_000 (* for a question about normal forms: section 3 *)
(* For a question about quotients section 3 names no bound: these are ours, and what is beyond them is outside. *)
let few_units = 300_000
let many_units = 1_500_000

let charge units =
  left := !left - units;
  if !left < 0 then raise Too_much

(* Sums and products *)

let nothing : form = Terms.empty
let rational q : form = if Q.sign q = 0 then nothing else Terms.singleton [] q
let unit_form = rational Q.one
let of_monomial m : form = Terms.singleton m Q.one
let of_atom a = of_monomial [ (intern a, Q.one) ]

let add (a : form) (b : form) : form =
  let join _ p q = let s = Q.add p q in if Q.sign s = 0 then None else Some s in
  Terms.union join a b

let rec join_monomials (a : Monomial.t) (b : Monomial.t) : Monomial.t =
  match (a, b) with
  | [], m | m, [] -> m
  | (i, p) :: a', (j, q) :: b' ->
      if i < j then (i, p) :: join_monomials a' b
      else if i > j then (j, q) :: join_monomials a b'
      else
        let s = Q.add p q in
        if Q.sign s = 0 then join_monomials a' b' else (i, s) :: join_monomials a' b'

let scale c (a : form) : form = if Q.sign c = 0 then nothing else Terms.map (Q.mul c) a
let negative a = scale Q.minus_one a

let add_term m c (a : form) : form =
  let change = function
    | None -> Some c
    | Some d -> let s = Q.add c d in if Q.sign s = 0 then None else Some s
  in
  Terms.update m change a

let multiply (a : form) (b : form) : form =
  charge (max 1 (Terms.cardinal a) * max 1 (Terms.cardinal b));
  let row m c sum = Terms.fold (fun n d sum -> add_term (join_monomials m n) (Q.mul c d) sum) b sum in
  Terms.fold row a nothing

let largest_power = Z.of_int 100_000

let rec whole_power a n =
  if Z.gt n largest_power then refuse "a power of more than %s" (Z.to_string largest_power);
  if Z.sign n = 0 then unit_form
  else if Z.equal n Z.one then a
  else
    let half = whole_power a (Z.shift_right n 1) in
    let square = multiply half half in
    if Z.is_even n then square else multiply square a

let power_monomial (m : Monomial.t) q : Monomial.t = if Q.sign q = 0 then [] else List.map (fun (i, p) -> (i, Q.mul p q)) m

let rational_power c n =
  if Z.gt (Z.abs n) largest_power then refuse "a power of more than %s" (Z.to_string largest_power);
  let up = Z.to_int (Z.abs n) in
  let p = Q.make (Z.pow c.Q.num up) (Z.pow c.Q.den up) in
  if Z.sign n < 0 then Q.inv p else p

let key (a : form) : key = Terms.bindings a

(* [Some q] for a form that is the number q *)
let as_number (a : form) =
  match key a with [] -> Some Q.zero | [ ([], q) ] -> Some q | _ -> None

let of_key (k : key) : form = List.fold_left (fun a (m, c) -> Terms.add m c a) nothing k
let floor q = Z.fdiv q.Q.num q.Q.den
let fraction q = Q.sub q (Q.of_bigint (floor q))
let circle () : Monomial.t = [ (intern Circle, Q.one) ]

(* Is a normal form zero? *)

let is_root i = match Hashtbl.find atoms i with Root _ -> true | _ -> false

(* The root with the highest number: no other root of the form lies around it. *)
let last_root (a : form) =
  let in_monomial m _ best = List.fold_left (fun best (i, _) -> if is_root i then max best i else best) best m in
  Terms.fold in_monomial a (-1)

let exponent_of i (m : Monomial.t) = Option.value ~default:Q.zero (List.assoc_opt i m)

(* The form divided by S^low, as a list of r and N_r with 0 <= r < 1: the form is the sum of S^r N_r, and S^k is R^k for whole k. *)
let sort_by_root i (a : form) =
  let content = match Hashtbl.find atoms i with Root k -> of_key k | _ -> assert false in
  let low = Terms.fold (fun m _ low -> Q.min low (exponent_of i m)) a (exponent_of i (fst (Terms.min_binding a))) in
  let place m c groups =
    let e = Q.sub (exponent_of i m) low in
    let whole = floor e in
    let r = Q.sub e (Q.of_bigint whole) in
    let rest = List.filter (fun (j, _) -> j <> i) m in
    let same, others = List.partition (fun ((r', k), _) -> Q.equal r r' && Z.equal k whole) groups in
    let old = match same with [ (_, f) ] -> f | _ -> nothing in
    ((r, whole), add_term rest c old) :: others
  in
  let groups = Terms.fold place a [] in
  let collect sums ((r, k), f) =
    let value = multiply f (whole_power content k) in
    let same, others = List.partition (fun (r', _) -> Q.equal r r') sums in
    (r, match same with [ (_, old) ] -> add old value | _ -> value) :: others
  in
  List.fold_left collect [] groups

(* The cyclotomic polynomial of order n: the product of (x^d - 1)^mu(n/d) *)
let cyclotomic n =
  let rec mu n p =
    if n = 1 then 1 else if p * p > n then -1
    else if n mod p <> 0 then mu n (p + 1)
    else if n / p mod p = 0 then 0
    else -mu (n / p) (p + 1)
  in
  let divisors = List.filter (fun d -> n mod d = 0) (List.init n (fun i -> i + 1)) in
  let times_binomial a d =
    let size = Array.length a in
    Array.init (size + d) (fun j ->
        Z.sub (if j >= d then a.(j - d) else Z.zero) (if j < size then a.(j) else Z.zero))
  in
  let over_binomial a d =
    (* a = (x^d - 1) q, so q_j = q_(j - d) - a_j *)
    let q = Array.make (Array.length a - d) Z.zero in
    Array.iteri (fun j _ -> q.(j) <- Z.sub (if j >= d then q.(j - d) else Z.zero) a.(j)) q;
    q
  in
  let pick sign = List.filter (fun d -> mu (n / d) 2 = sign) divisors in
  List.fold_left over_binomial (List.fold_left times_binomial [| Z.one |] (pick 1)) (pick (-1))

(* The remainder of the division by a monic polynomial *)
let remainder phi p =
  let p = Array.copy p and degree = Array.length phi - 1 in
  for j = Array.length p - 1 downto degree do
    let c = p.(j) in
    if Q.sign c <> 0 then
      Array.iteri (fun k f -> if Z.sign f <> 0 then p.(j - degree + k) <- Q.sub p.(j - degree + k) (Q.mul c (Q.of_bigint f))) phi
  done;
  p

(* Without roots: the coefficients are polynomials in z = exp(i pi/n), with z^n = -1, and so their remainders. *)
let reduce_on_the_circle (a : form) : form =
  let turn = intern (Cis (circle ())) in
  let n = Terms.fold (fun m _ n -> Z.lcm n (exponent_of turn m).Q.den) a Z.one in
  if Z.gt n (Z.of_int 5040) then refuse "an angle of more than 5040 parts of pi";
  let n = Z.to_int n in
  let sort m c sums =
    let e = Q.mul (exponent_of turn m) (Q.of_int n) in
    let k = Z.to_int (Z.erem e.Q.num (Z.of_int (2 * n))) in
    let rest = List.filter (fun (j, _) -> j <> turn) m in
    let p = match Terms.find_opt rest sums with Some p -> p | None -> Array.make n Q.zero in
    p.(k mod n) <- (if k < n then Q.add else Q.sub) p.(k mod n) c;
    Terms.add rest p sums
  in
  let sums = Terms.fold sort a Terms.empty in
  let all_zero p = Array.for_all (fun c -> Q.sign c = 0) p in
  if Terms.for_all (fun _ p -> all_zero p) sums then nothing
  else
    let phi = cyclotomic (2 * n) in
    let write rest p form =
      let put form k c =
        if Q.sign c = 0 then form
        else multiply (Terms.singleton rest c) (of_monomial (if k = 0 then [] else [ (turn, Q.of_ints k n) ])) |> add form
      in
      snd (Array.fold_left (fun (k, form) c -> (k + 1, put form k c)) (0, form) (remainder phi p))
    in
    Terms.fold write sums nothing

let vanishes_on_the_circle a = Terms.is_empty (reduce_on_the_circle a)

let is_on_the_circle (m : Monomial.t) =
  let turn = intern (Cis (circle ())) in
  List.for_all (fun (i, _) -> i = turn) m

let meets_the_circle (a : form) =
  let turn = intern (Cis (circle ())) in
  Terms.exists (fun m _ -> List.exists (fun (i, _) -> i = turn) m) a

let rec is_zero (a : form) =
  Terms.is_empty a
  ||
  match last_root a with
  | -1 -> vanishes_on_the_circle a
  | i -> List.for_all (fun (_, f) -> is_zero f) (sort_by_root i a)

(* Primes: trial, then Pollard's rho. A factor that is taken for a prime and is none does no harm: the product is still the number. *)

let rec split_number n =
  let rec rho c =
    let step x = Z.erem (Z.add (Z.mul x x) c) n in
    let rec go x y count =
      if count > 3_000_000 then n
      else
        let x = step x and y = step (step y) in
        let d = Z.gcd (Z.sub x y) n in
        if Z.equal d Z.one then go x y (count + 1) else if Z.equal d n then rho (Z.succ c) else d
    in
    go (Z.of_int 2) (Z.of_int 2) 0
  in
  if Z.equal n Z.one then []
  else if Z.probab_prime n 30 > 0 then [ n ]
  else
    let d = if Z.is_even n then Z.of_int 2 else if Z.perfect_square n then Z.sqrt n else rho Z.one in
    if Z.equal d n then [ n ] else split_number d @ split_number (Z.divexact n d)

let primes_of n =
  let rec trial n p found =
    if p > 1000 then (n, found)
    else
      let q, r = Z.div_rem n (Z.of_int p) in
      if Z.sign r = 0 then trial q p (Z.of_int p :: found) else trial n (p + 1) found
  in
  let rest, small = trial n 2 [] in
  small @ split_number rest

let exponents_of c =
  let count sign found p =
    let old = Option.value ~default:0 (List.assoc_opt p found) in
    (p, old + sign) :: List.remove_assoc p found
  in
  List.fold_left (count (-1)) (List.fold_left (count 1) [] (primes_of c.Q.num)) (primes_of c.Q.den)

(* Powers *)

let half = Q.of_ints 1 2

(* cis(c M) for a monomial M, and cos(c pi), without the rules for inverse functions *)
let cis_of m c = of_monomial (power_monomial [ (intern (Cis m), Q.one) ] c)
let cos_of_circle c = scale half (add (cis_of (circle ()) c) (cis_of (circle ()) (Q.neg c)))

let root_of (r : form) q =
  match as_number r with
  | Some c when Q.equal c Q.one -> unit_form
  | _ -> of_monomial (power_monomial [ (intern (Root (key r)), Q.one) ] q)

(* p^r for a prime p and 0 < r < 1 *)
let prime_root p r =
  let circle_form p =
    match Z.to_int p with
    | 2 -> Some (scale (Q.of_int 2) (cos_of_circle (Q.of_ints 1 4)))
    | 3 -> Some (scale (Q.of_int 2) (cos_of_circle (Q.of_ints 1 6)))
    | 5 -> Some (add (scale (Q.of_int 4) (cos_of_circle (Q.of_ints 1 5))) (rational Q.minus_one))
    | _ -> None
  in
  let known = if Q.equal r half && Z.leq p (Z.of_int 5) then circle_form p else None in
  match known with Some a -> a | None -> root_of (rational (Q.of_bigint p)) r

let power_of_number c q =
  if Z.numbits (Z.mul c.Q.num c.Q.den) > 100 then refuse "a root of a number of more than 100 bits";
  let one_prime a (p, e) =
    let r = Q.mul (Q.of_int e) q in
    let f = fraction r in
    let a = scale (rational_power (Q.of_bigint p) (floor r)) a in
    if Q.sign f = 0 then a else multiply a (prime_root p f)
  in
  List.fold_left one_prime unit_form (exponents_of c)

let content (a : form) =
  let join _ c (n, d) = (Z.gcd n c.Q.num, Z.lcm d c.Q.den) in
  let n, d = Terms.fold join a (Z.zero, Z.one) in
  Q.make n d

let is_even_whole (_, e) = is_even e

(* The rational number that the square of a number on the circle is *)
let rational_square (a : form) =
  if not (Terms.for_all (fun m _ -> is_on_the_circle m) a) then None
  else match key (reduce_on_the_circle (multiply a a)) with [ ([], r) ] -> Some r | _ -> None

let rec power (a : form) q =
  if is_whole q && Q.sign q >= 0 then whole_power a q.Q.num
  else
    match key a with
    | k when (match k with [ _ ] -> false | _ -> is_zero a) -> refuse "a power of 0"
    | [ (m, c) ] when is_whole q -> Terms.singleton (power_monomial m q) (rational_power c q.Q.num)
    | _ when is_whole q && rational_square a <> None ->
        whole_power (scale (Q.inv (Option.get (rational_square a))) a) (Z.neg q.Q.num)
    | k when meets_the_circle a && key (reduce_on_the_circle a) <> k -> power (reduce_on_the_circle a) q
    | [ (m, c) ] when Q.equal c Q.one && List.length m >= 2 && List.for_all is_even_whole m ->
        let one_factor p (i, e) =
          multiply p (root_of (of_monomial [ (i, Q.of_int 2) ]) (Q.mul q (Q.div e (Q.of_int 2))))
        in
        List.fold_left one_factor unit_form m
    | _ ->
        let c = content a in
        multiply (power_of_number c q) (root_of (scale (Q.inv c) a) q)

(* Functions *)

let single (m : Monomial.t) = match m with [ (i, q) ] when Q.equal q Q.one -> Some (Hashtbl.find atoms i) | _ -> None

let turned (a : form) = if meets_the_circle a then reduce_on_the_circle a else a
let product_of_terms f (a : form) = Terms.fold (fun m c p -> multiply p (f m c)) (turned a) unit_form

let exp_form =
  product_of_terms (fun m c ->
      match single m with
      | Some (Log k) -> power (of_key k) c
      | _ -> of_monomial (power_monomial [ (intern (Exp m), Q.one) ] c))

let square a = multiply a a
let imaginary sign = cis_of (circle ()) (Q.of_ints sign 2)

(* cos and sin of asin(u), acos(u), atan(u), atan2(y, x) *)
let cos_sin_of_arc = function
  | Asin k -> let u = of_key k in Some (power (add unit_form (negative (square u))) half, u)
  | Acos k -> let u = of_key k in Some (u, power (add unit_form (negative (square u))) half)
  | Atan k ->
      let u = of_key k in
      let r = power (add unit_form (square u)) (Q.neg half) in
      Some (r, multiply u r)
  | Atan2 (y, x) ->
      let y = of_key y and x = of_key x in
      let r = power (add (square x) (square y)) (Q.neg half) in
      Some (multiply x r, multiply y r)
  | _ -> None

let cis_form =
  product_of_terms (fun m c ->
      match Option.bind (if is_whole c then single m else None) cos_sin_of_arc with
      | Some (a, b) -> whole_power (add a (multiply (imaginary (Q.sign c)) b)) (Z.abs c.Q.num)
      | None -> cis_of m c)

let cos_form a = scale half (add (cis_form a) (cis_form (negative a)))
let sin_form a = cos_form (add a (scale (Q.neg half) (of_monomial (circle ()))))

let log_form a =
  let exponent (i, q) = match Hashtbl.find atoms i with Exp m -> Some (m, q) | _ -> None in
  match key a with
  | [ (m, c) ] when Q.equal c Q.one && m <> [] && List.for_all (fun f -> exponent f <> None) m ->
      List.fold_left (fun sum (m, q) -> add_term m q sum) nothing (List.filter_map exponent m)
  | k -> of_atom (Log k)

(* An atom that may be 0 together with its neighbours stands somewhere in the form. *)
let rec has_hidden_zero (a : key) = List.exists (fun (m, _) -> hides m) a

and hides (m : Monomial.t) =
  let hidden = function
    | Root _ | Log _ | Asin _ | Acos _ | Atan _ | Atan2 _ -> true
    | Erf k -> has_hidden_zero k
    | Exp m | Cis m -> hides m
    | Circle | Symbol _ | Part _ -> false
  in
  List.exists (fun (i, _) -> hidden (Hashtbl.find atoms i)) m

let inverse a = power a Q.minus_one

let tail_form name k a =
  if has_hidden_zero (key a) then refuse "%s_%d of a root or of an inverse function" name k;
  let full = match name with "exp" -> exp_form a | "sin" -> sin_form a | _ -> cos_form a in
  let coefficient j =
    match (name, j land 3) with
    | "exp", _ | "sin", 1 | "cos", 0 -> Q.one
    | "sin", 3 | "cos", 2 -> Q.minus_one
    | _ -> Q.zero
  in
  let rec start j factorial sum =
    if j = k then sum
    else
      let term = scale (Q.div (coefficient j) factorial) (whole_power a (Z.of_int j)) in
      start (j + 1) (Q.mul factorial (Q.of_int (j + 1))) (add sum term)
  in
  multiply (add full (negative (start 0 Q.one nothing))) (power a (Q.of_int (-k)))

let function_form name a =
  let two = Q.of_int 2 and a = turned a in
  let hyperbolic sign = scale half (add (exp_form a) (scale (Q.of_int sign) (exp_form (negative a)))) in
  match name with
  | "exp" -> exp_form a
  | "sin" -> sin_form a
  | "cos" -> cos_form a
  | "tan" -> multiply (sin_form a) (inverse (cos_form a))
  | "cot" -> multiply (cos_form a) (inverse (sin_form a))
  | "sec" -> inverse (cos_form a)
  | "csc" -> inverse (sin_form a)
  | "sinh" -> hyperbolic (-1)
  | "cosh" -> hyperbolic 1
  | "tanh" -> add unit_form (scale (Q.neg two) (inverse (add (exp_form (scale two a)) unit_form)))
  | "log" -> log_form a
  | "sqrt" -> power a half
  | "abs" -> power (square a) half
  | "asin" -> of_atom (Asin (key a))
  | "acos" -> of_atom (Acos (key a))
  | "atan" -> of_atom (Atan (key a))
  | "erf" ->
      if Terms.is_empty a then nothing
      else
        let sign = Q.of_int (Q.sign (snd (Terms.min_binding a))) in
        scale sign (of_atom (Erf (key (scale sign a))))
  | _ -> ( match tail_order name with Some (f, k) -> tail_form f k a | None -> outside "function %s" name)

let rec normal t : form =
  match t with
  | Num q -> rational q
  | Pi -> of_monomial (circle ())
  | Sym s -> of_atom (Symbol s)
  | Sum l -> List.fold_left (fun a t -> add a (normal t)) nothing l
  | Prod l -> List.fold_left (fun a t -> multiply a (normal t)) unit_form l
  | Pow (a, b) -> (
      match !constant b with
      | Some q -> power (normal a) q
      | None -> exp_form (multiply (normal b) (log_form (normal a))))
  | Fun ("atan2", [ y; x ]) -> of_atom (Atan2 (key (turned (normal y)), key (turned (normal x))))
  | Fun (name, [ x ]) -> function_form name (normal x)
  | Fun (name, _) -> outside "function %s" name

(* Quotients of polynomials in parts of the tree: a numerator over powers of polynomials with leading coefficient 1 *)

type quotient = { over : form; under : (key * int) list }

exception No_quotient

let multiplicity f l = Option.value ~default:0 (List.assoc_opt f l)

let merge op a b =
  let names = List.sort_uniq compare (List.map fst a @ List.map fst b) in
  List.map (fun f -> (f, op (multiplicity f a) (multiplicity f b))) names

let expand under = List.fold_left (fun p (f, n) -> multiply p (whole_power (of_key f) (Z.of_int n))) unit_form under

let quotient_sum a b =
  if Terms.is_empty a.over then b
  else if Terms.is_empty b.over then a
  else if a.under = b.under then { a with over = add a.over b.over }
  else
    let under = merge max a.under b.under in
    let lift q = multiply q.over (expand (merge ( - ) under q.under)) in
    { over = add (lift a) (lift b); under }

let quotient_product a b =
  { over = multiply a.over b.over; under = (if a.under = [] then b.under else if b.under = [] then a.under else merge ( + ) a.under b.under) }

(* A polynomial of one term is a unit among polynomials with exponents of either sign. *)
let quotient_inverse q =
  match key q.over with
  | [] -> raise No_quotient
  | [ (m, c) ] -> { over = multiply (Terms.singleton (power_monomial m Q.minus_one) (Q.inv c)) (expand q.under); under = [] }
  | (_, c) :: _ -> { over = scale (Q.inv c) (expand q.under); under = [ (key (scale (Q.inv c) q.over), 1) ] }

let whole_exponent t =
  match !constant t with Some q when is_whole q && Z.leq (Z.abs q.Q.num) (Z.of_int 1000) -> Some (Z.to_int q.Q.num) | _ -> None

let rec quotient t =
  let go = quotient in
  let generator () = { over = of_atom (Part t); under = [] } in
  match t with
  | Num q -> { over = rational q; under = [] }
  | Sum l -> List.fold_left (fun a t -> quotient_sum a (go t)) { over = nothing; under = [] } l
  | Prod l -> List.fold_left (fun a t -> quotient_product a (go t)) { over = unit_form; under = [] } l
  | Pow (a, b) -> ( match whole_exponent b with Some n -> quotient_power (go a) n | None -> generator ())
  | Pi | Sym _ | Fun _ -> generator ()

and quotient_power q n =
  if n = 0 && Terms.is_empty q.over then raise No_quotient
  else if n < 0 then quotient_power (quotient_inverse q) (-n)
  else { over = whole_power q.over (Z.of_int n); under = List.map (fun (f, k) -> (f, k * n)) (if n = 0 then [] else q.under) }

let rec generators t =
  match t with
  | Num _ -> []
  | Sum l | Prod l -> List.concat_map generators l
  | Pow (a, b) when whole_exponent b <> None -> generators a
  | Pow _ | Pi | Sym _ | Fun _ -> [ t ]

let has_other_generator t = List.exists (function Sym _ -> false | _ -> true) (generators t)

(* One question about normal forms *)
let counted f x =
  left := most_work;
  try f x with Too_much -> refuse "more than %d units of work" most_work

let normal_form_vanishes = counted (fun t -> is_zero (normal t))

let atom_of i = Hashtbl.find atoms i

(* The atoms inside an atom, at any depth *)
let rec atoms_inside atom =
  let of_monomial m = List.concat_map (fun (i, _) -> let a = atom_of i in a :: atoms_inside a) m in
  let of_form k = List.concat_map (fun (m, _) -> of_monomial m) k in
  match atom with
  | Circle | Symbol _ | Part _ -> []
  | Log k | Asin k | Acos k | Atan k | Erf k | Root k -> of_form k
  | Atan2 (y, x) -> of_form y @ of_form x
  | Exp m | Cis m -> of_monomial m

(* Numerator, and denominators with their powers; generators are atoms [Part]. *)
let split_quotient t =
  left := many_units;
  match quotient t with
  | q -> (key q.over, q.under)
  | exception No_quotient -> refuse "a division by 0"
  | exception Too_much -> outside "a quotient with more than %d units of work" many_units

let try_quotient units t =
  left := units;
  try if Terms.is_empty (quotient t).over then `Yes else `No with No_quotient -> `No | Too_much -> `Too_much

(* The tree where every sum of plain products is written in a basis of the space that these sums span, with new symbols for the basis.
   If this vanishes for all values of the new symbols, so does the tree. Only for trees that are too large otherwise. *)
let group_sums t =
  let rec is_plain = function
    | Num _ | Sym _ -> true
    | Prod l -> List.for_all is_plain l
    | Pow (a, e) -> ( match whole_exponent e with Some n -> n > 0 && is_plain a | None -> false)
    | Sum _ | Fun _ | Pi -> false
  in
  let basis = ref [] (* pivot and form, in order *) in
  let coefficient m f = Option.value ~default:Q.zero (Terms.find_opt m f) in
  let reduce (f, shares) (k, (pivot, row)) =
    let c = coefficient pivot f in
    if Q.sign c = 0 then (f, shares) else (add f (scale (Q.neg c) row), (k, c) :: shares)
  in
  let coordinates f =
    let rest, shares = List.fold_left reduce (f, []) (List.mapi (fun k row -> (k, row)) !basis) in
    if Terms.is_empty rest then shares
    else begin
      let pivot, c = Terms.min_binding rest in
      let k = List.length !basis in
      basis := !basis @ [ (pivot, scale (Q.inv c) rest) ];
      (k, c) :: shares
    end
  in
  let share (k, c) = Prod [ Num c; Sym (Printf.sprintf "#%d" k) ] in
  let change = function
    | Sum l as t when List.for_all is_plain l -> Some (Sum (zero :: List.map share (coordinates (quotient t).over)))
    | _ -> None
  in
  left := many_units;
  try replace change t with Too_much -> t

(* A quotient that is too large at first is tried in grouped form, and once more with more work. *)
let vanishes_as_quotient t =
  match try_quotient few_units t with
  | `Too_much -> if try_quotient many_units (group_sums t) = `Yes then `Yes else try_quotient many_units t
  | answer -> answer

(* "Is seen to vanish" *)
let vanishes t =
  let as_quotient = vanishes_as_quotient t in
  if as_quotient = `Yes || (has_other_generator t && normal_form_vanishes t) then true
  else if as_quotient = `No then false
  else outside "a quotient with more than %d units of work" many_units

(* The constant of an exponent *)

let constants : (tree, Q.t option) Hashtbl.t = Hashtbl.create 64

let find_constant t =
  if has_symbols t then None
  else
    let saved = !left in
    left := most_work;
    let number = try as_number (normal t) with Too_much -> refuse "more than %d units of work" most_work in
    left := saved;
    match number with
    | Some _ when Value.finite_ball Value.no_symbols t = None -> refuse "an exponent without a value"
    | found -> found

let exponent_constant t =
  let found =
    match t with
    | Num q -> Some q
    | Sym _ -> None
    | _ -> (
        match Hashtbl.find_opt constants t with
        | Some found -> found
        | None ->
            let found = find_constant t in
            Hashtbl.replace constants t found;
            found)
  in
  match found with
  | Some q when Q.geq (Q.abs q) (Q.of_int 1000) -> refuse "an exponent of 1000 or more"
  | found -> found

let () = constant := exponent_constant

let forget () =
  Table.reset numbers;
  Hashtbl.reset atoms;
  Hashtbl.reset constants
