(* Ranges and goals, and the parts of the rules that make premises. Sections 5 and 7 of docs/certificates.md. *)

open Text
open Tree
open Ball
open Value
open Algebra

(* Ranges *)

type range = { low : tree option; high : tree option; open_low : bool; open_high : bool; nonzero : bool; integer : bool }

let anything = { low = None; high = None; open_low = false; open_high = false; nonzero = false; integer = false }

let read_end what = function
  | Null -> None
  | value ->
      let t = get_tree what value in
      ignore (number_ball what t);
      Some t

let read_range what value =
  match get_list what value with
  | [ low; high; flags ] ->
      let set r flag =
        match get_text what flag with
        | "open-low" -> { r with open_low = true }
        | "open-high" -> { r with open_high = true }
        | "nonzero" -> { r with nonzero = true }
        | "integer" -> { r with integer = true }
        | f -> refuse "%s: unknown flag %S" what f
      in
      let r = { anything with low = read_end what low; high = read_end what high } in
      List.fold_left set r (get_list what flags)
  | _ -> refuse "%s: expected [low, high, flags]" what

let shown what = function true -> () | false -> refuse "%s" what

(* A number is shown to lie in a range. *)
let check_inside name r t =
  let outside_range () = refuse "%s lies outside its range, or is not shown to lie there" name in
  let x = number_ball name t in
  if r.integer then (match !constant t with Some q when is_whole q -> () | _ -> outside_range ());
  if r.nonzero && has_zero x then outside_range ();
  let check_end is_open distance =
    match finite_ball no_symbols distance with
    | Some d when is_above d -> ()
    | _ -> if is_open || not (vanishes distance) then outside_range ()
  in
  Option.iter (fun low -> check_end r.open_low (subtract t low)) r.low;
  Option.iter (fun high -> check_end r.open_high (subtract high t)) r.high

let check_point box point =
  if List.length box <> List.length point || not (List.for_all (fun (s, _) -> List.mem_assoc s point) box) then
    refuse "expected a number for every symbol and no other";
  List.iter (fun (s, r) -> check_inside s r (List.assoc s point)) box

let read_numbers what value =
  let read (name, v) =
    let t = get_tree what v in
    if has_symbols t then refuse "%s: expected no symbols" what;
    if not (is_name name) then refuse "%s: expected a name" what;
    (name, t)
  in
  List.map read (get_object what value)

(* Goals *)

type goal = {
  tree : tree;
  relation : relation;
  box : (string * range) list;
  exists : tree list;
  given : tree list;
  zeros : tree list;
}

let premise goal tree relation = { goal with tree; relation }
let remember goal tree relation = { goal with tree; relation; exists = goal.tree :: goal.exists }
let alone tree relation = { tree; relation; box = []; exists = []; given = []; zeros = [] }
let all_trees goal = (goal.tree :: goal.exists) @ goal.given @ goal.zeros

let check_symbols goal =
  let check s = if not (List.mem_assoc s goal.box) then refuse "the symbol %s has no range" s in
  List.iter (fun t -> Names.iter check (symbols t)) (all_trees goal)

let range_of goal name =
  match List.assoc_opt name goal.box with Some r -> r | None -> refuse "the symbol %s is without a range" name

let with_range goal name range = { goal with box = (name, range) :: List.remove_assoc name goal.box }

(* Cuts the range of a symbol that is known to be >= 0 (side 1) or <= 0 (side -1). *)
let cut_range goal name side =
  let r = range_of goal name in
  let reaches is_beyond = function
    | None -> true
    | Some t -> ( match finite_ball no_symbols t with Some x -> is_beyond x | None -> false)
  in
  if side = 1 then
    if reaches is_below r.low then with_range goal name { r with low = Some zero; open_low = false } else goal
  else if reaches is_above r.high then with_range goal name { r with high = Some zero; open_high = false }
  else goal

(* The keys of a rule, beside `rule` *)
let rule_keys value names = List.tl (get_keys "proof" ("rule" :: names) value)
let key_of value name = match rule_keys value [ name ] with [ v ] -> v | _ -> assert false

let require goal relations = if not (List.mem goal.relation relations) then refuse "this rule is for another relation"

let get_sign what = function Int z when Z.equal (Z.abs z) Z.one -> Z.to_int z | _ -> refuse "%s: expected the sign 1 or -1" what
let signed sign t = if sign = 1 then t else negate t

let same_length what a b =
  if List.length a <> List.length b then refuse "%s: expected %d entries, got %d" what (List.length a) (List.length b)

let require_equal what a b = if not (vanishes (subtract a b)) then refuse "%s: the terms differ" what

(* Defined: which conditions still want a proof *)

let implies (r, t) (r', t') =
  equal t t' && (r = r' || (r = Above && (r' = AtLeast || r' = Unequal)))

let open_conditions level goal trees =
  let known = conditions 0 (goal.tree :: goal.exists) in
  let is_settled (r, t) =
    List.exists (fun k -> implies k (r, t)) known
    || ((not (has_symbols t)) && match finite_ball no_symbols t with Some x -> satisfies r x | None -> false)
    || List.exists (fun (r', t') -> r = r' && vanishes (subtract t' t)) known
  in
  List.filter (fun c -> not (is_settled c)) (conditions level trees)

(* Exponents that are compared by `rewrite` and `abstract` *)

let rec check_exponents ~skip change t =
  if not (skip t) then begin
    (match t with
    | Pow (_, e) -> (
        match !constant e with
        | Some q -> if !constant (change e) <> Some q then refuse "an exponent changes"
        | None -> ())
    | _ -> ());
    List.iter (check_exponents ~skip change) (parts t)
  end

(* Rules of signs: parts *)

let is_even_part t =
  match t with
  | Pow (_, e) -> ( match !constant e with None -> true | Some q -> (not (is_whole q)) || is_even q)
  | Fun (("exp" | "cosh" | "abs" | "sqrt" | "acos"), _) -> true
  | _ -> false

let cannot_be_zero t =
  match t with
  | Pow (_, e) -> ( match !constant e with None -> true | Some q -> Q.sign q <= 0)
  | Fun (("exp" | "cosh"), _) -> true
  | _ -> false

let base_and_exponent t =
  match t with Pow (b, e) -> Option.map (fun q -> (b, q)) (!constant e) | _ -> Some (t, Q.one)

(* The middle m and the half width h of the values of a function, and whether it reaches its ends *)
let known_range = function
  | Fun (("sin" | "cos"), _) -> (zero, one, true)
  | Fun (("tanh" | "erf"), _) -> (zero, one, false)
  | Fun ("atan", _) -> (zero, half_pi, false)
  | Fun ("asin", _) -> (zero, half_pi, true)
  | Fun ("acos", _) -> (half_pi, half_pi, true)
  | Fun ("atan2", _) -> (zero, Pi, true)
  | _ -> refuse "bounded: a function without a known range"

let sum_of = function [ t ] -> t | l -> Sum l
let product_of = function [ t ] -> t | l -> Prod l

(* The tree that `bounded` asks for, and whether one of its functions stays away from its ends *)
let bounded_tree t =
  let stays = ref false in
  let bound term =
    if not (has_symbols term) then `Fixed term
    else
      match List.partition has_symbols (factors term) with
      | [ g ], others ->
          let m, h, reaches = known_range g in
          let c = product_of (others @ [ one ]) in
          let away_from_zero = match finite_ball no_symbols c with Some x -> not (has_zero x) | None -> false in
          if (not reaches) && away_from_zero then stays := true;
          `Bounded (Prod [ c; m ], negate (Prod [ apply "abs" c; h ]))
      | _ -> refuse "bounded: a product of functions"
  in
  let found = List.map bound (terms t) in
  let fixed = List.filter_map (function `Fixed t -> Some t | _ -> None) found in
  let others = List.concat_map (function `Bounded (a, b) -> [ a; b ] | _ -> []) found in
  (sum_of (fixed @ others), !stays)

(* The premises of `solve`, with their relations *)
let solve_premises a v =
  let square t = Prod [ t; t ] in
  let sine = apply "sin" v and cosine = apply "cos" v in
  match a with
  | Fun ("log", [ u ]) -> [ (subtract (apply "exp" v) u, Equal) ]
  | Fun ("sqrt", [ u ]) -> [ (subtract (square v) u, Equal); (v, AtLeast) ]
  | Fun ("abs", [ u ]) -> [ (subtract (square v) (square u), Equal); (v, AtLeast) ]
  | Fun ("asin", [ u ]) ->
      [ (subtract sine u, Equal); (Sum [ half_pi; v ], AtLeast); (subtract half_pi v, AtLeast) ]
  | Fun ("acos", [ u ]) -> [ (subtract cosine u, Equal); (v, AtLeast); (subtract Pi v, AtLeast) ]
  | Fun ("atan", [ u ]) ->
      [ (subtract (Prod [ u; cosine ]) sine, Equal); (Sum [ half_pi; v ], Above); (subtract half_pi v, Above) ]
  | Fun ("atan2", [ y; x ]) ->
      [
        (subtract (Prod [ x; sine ]) (Prod [ y; cosine ]), Equal);
        (Sum [ Prod [ x; cosine ]; Prod [ y; sine ] ], Above);
        (subtract Pi v, AtLeast);
        (Sum [ Pi; v ], Above);
      ]
  | Pow (u, e) -> (
      match !constant e with
      | Some q ->
          let n = Num (Q.of_bigint q.Q.num) and d = Num (Q.of_bigint q.Q.den) in
          [ (subtract (Pow (v, d)) (Pow (u, n)), Equal); (v, AtLeast) ]
      | None -> refuse "solve: an exponent that is not rational")
  | _ -> refuse "solve: expected an inverse function"

(* Each name stands in no atom of the normal form but itself, with exponents 0 and 1; no condition of the tree has it. *)
let check_degree_one names t =
  let stands_in s condition = Names.mem s (symbols (snd condition)) in
  let conditions = conditions 0 [ t ] in
  if List.exists (fun s -> List.exists (stands_in s) conditions) names then refuse "corners: a condition on a symbol";
  let is_corner = function Symbol s -> List.mem s names | _ -> false in
  let check (i, q) =
    let atom = atom_of i in
    if is_corner atom then (if not (Q.equal q Q.one) then refuse "corners: a higher degree")
    else if List.exists is_corner (atoms_inside atom) then refuse "corners: a symbol inside a function"
  in
  List.iter (fun (m, _) -> List.iter check m) (key (counted normal t))

(* An entire function, for `dense` *)
let rec check_entire t =
  if has_symbols t then
    match t with
    | Sym _ -> ()
    | Sum l | Prod l | Fun (("sin" | "cos" | "exp" | "sinh" | "cosh"), l) -> List.iter check_entire l
    | Pow (b, e) -> (
        match !constant e with
        | Some q when is_whole q && Q.sign q > 0 -> check_entire b
        | _ -> refuse "dense: expected an entire function")
    | _ -> refuse "dense: expected an entire function"

let get_bits most value = get_integer "bits" 53 most value

let at_precision bits f =
  let old = !precision in
  precision := bits + 32;
  Fun.protect ~finally:(fun () -> precision := old) f
