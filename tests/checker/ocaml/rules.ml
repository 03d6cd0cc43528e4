(* Goals and the rules that prove them. Sections 5 and 7 of docs/certificates.md. *)

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
        | "open-low" when not r.open_low -> { r with open_low = true }
        | "open-high" when not r.open_high -> { r with open_high = true }
        | "nonzero" when not r.nonzero -> { r with nonzero = true }
        | "integer" when not r.integer -> { r with integer = true }
        | f -> refuse "%s: unknown or repeated flag %S" what f
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
  | Fun ("tanh", _) -> (zero, one, false)
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

(* The rules *)

let get_bits most value = get_integer "bits" 53 most value

let at_precision bits f =
  let old = !precision in
  precision := bits + 32;
  Fun.protect ~finally:(fun () -> precision := old) f

let rec prove goal value =
  check_symbols goal;
  match List.assoc_opt "rule" (get_object "proof" value) with
  | None -> refuse "proof: expected the key rule"
  | Some rule -> (
      match get_text "rule" rule with
      | "identity" -> prove_identity goal value
      | "equal" -> prove_equal goal value
      | "modulo" -> prove_modulo goal value
      | "cases" -> prove_cases goal value
      | "zero" ->
          require goal [ AtLeast ];
          prove (premise goal goal.tree Equal) (key_of value "proof")
      | "between" -> prove_between goal value
      | "side" -> prove_side goal value
      | "rewrite" -> prove_rewrite goal value
      | "multiply" -> prove_multiply goal value
      | "exponential" ->
          prove (remember goal (subtract (apply "exp" goal.tree) one) goal.relation) (key_of value "proof")
      | "split" -> prove_split goal value
      | "integers" -> prove_integers goal value
      | "abstract" -> prove_abstract goal value
      | "solve" -> prove_solve goal value
      | "squares" -> prove_squares goal value
      | "balls" -> prove_balls goal value
      | "given" -> prove_given goal value
      | "range" -> prove_range goal value
      | "angle" -> prove_angle goal value
      | "bounded" -> prove_bounded goal value
      | "product" -> prove_product goal value
      | "sum" -> prove_sum goal value
      | name -> outside "rule %s" name)

and prove_each what goals proofs =
  same_length what goals proofs;
  List.iter2 prove goals proofs

and defined ?(level = 0) goal trees value =
  let wanted = open_conditions level goal trees in
  prove_each "defined" (List.map (fun (r, t) -> premise goal t r) wanted) (get_list "defined" value)

and prove_identity goal value =
  ignore (rule_keys value []);
  require goal [ Equal; AtLeast ];
  shown "the sides differ" (vanishes goal.tree)

and prove_equal goal value =
  match rule_keys value [ "to"; "defined"; "proof" ] with
  | [ target; conditions; proof ] ->
      let g = get_tree "to" target in
      require_equal "equal" goal.tree g;
      check_symbols (premise goal g goal.relation);
      defined goal [ g ] conditions;
      prove (remember goal g goal.relation) proof
  | _ -> assert false

and prove_modulo goal value =
  match rule_keys value [ "to"; "cofactors"; "defined"; "proof" ] with
  | [ target; cofactors; conditions; proof ] ->
      let g = get_tree "to" target in
      let factors = List.map (get_tree "cofactors") (get_list "cofactors" cofactors) in
      same_length "cofactors" goal.zeros factors;
      let share = List.map2 (fun c h -> Prod [ c; h ]) factors goal.zeros in
      List.iter (fun t -> check_symbols (premise goal t goal.relation)) (g :: factors);
      require_equal "modulo" goal.tree (sum_of (g :: share));
      defined goal (g :: factors) conditions;
      prove (remember goal g goal.relation) proof
  | _ -> assert false

and prove_cases goal value =
  match rule_keys value [ "of"; "proofs" ] with
  | [ of_; proofs ] ->
      let u = get_tree "of" of_ in
      check_symbols (premise goal u goal.relation);
      defined goal [ u ] (List []);
      let without v = replace (fun t -> if equal t (apply "abs" u) then Some v else None) goal.tree in
      let below t = match finite_ball no_symbols t with Some x -> is_below x | None -> false in
      let above t = match finite_ball no_symbols t with Some x -> is_above x | None -> false in
      let cut side g =
        match u with
        | Sym s ->
            let r = range_of g s in
            if side = 1 then
              if Option.fold ~none:true ~some:below r.low then with_range g s { r with low = Some zero; open_low = false } else g
            else if Option.fold ~none:true ~some:above r.high then
              with_range g s { r with high = Some zero; open_high = false }
            else g
        | _ -> g
      in
      let case side =
        let v = signed side u in
        let g = remember goal (without v) goal.relation in
        cut side { g with given = g.given @ [ v ] }
      in
      prove_each "cases" [ case 1; case (-1) ] (get_list "proofs" proofs)
  | _ -> assert false

and prove_between goal value =
  require goal [ Equal ];
  let goals = [ remember goal goal.tree AtLeast; remember goal (negate goal.tree) AtLeast ] in
  prove_each "between" goals (get_list "proofs" (key_of value "proofs"))

and prove_side goal value =
  match rule_keys value [ "sign"; "proof" ] with
  | [ sign; proof ] ->
      require goal [ Unequal ];
      let sign = if get_integer "sign" (-1) 1 sign = 1 then 1 else -1 in
      prove (remember goal (signed sign goal.tree) Above) proof
  | _ -> assert false

and prove_rewrite goal value =
  match rule_keys value [ "from"; "to"; "defined"; "equal"; "proof" ] with
  | [ source; target; conditions; same; proof ] ->
      let a = get_tree "from" source and b = get_tree "to" target in
      let change = replace (fun t -> if equal t a then Some b else None) in
      List.iter (fun t -> check_symbols (premise goal t goal.relation)) [ a; b ];
      check_exponents ~skip:(equal a) change goal.tree;
      defined goal [ a; b ] conditions;
      prove (remember goal (subtract a b) Equal) same;
      prove (remember goal (change goal.tree) goal.relation) proof
  | _ -> assert false

and prove_multiply goal value =
  match rule_keys value [ "by"; "defined"; "positive"; "proof" ] with
  | [ by; conditions; positive; proof ] ->
      let c = get_tree "by" by in
      check_symbols (premise goal c goal.relation);
      defined goal [ c ] conditions;
      prove (remember goal c Above) positive;
      prove (remember goal (Prod [ c; goal.tree ]) goal.relation) proof
  | _ -> assert false

and prove_split goal value =
  match rule_keys value [ "symbol"; "at"; "proofs" ] with
  | [ symbol; at; proofs ] ->
      let s = get_name "symbol" symbol and m = get_tree "at" at in
      ignore (number_ball "at" m);
      let r = range_of goal s in
      let lower = with_range goal s { r with high = Some m; open_high = false } in
      let upper = with_range goal s { r with low = Some m; open_low = false } in
      prove_each "split" [ lower; upper ] (get_list "proofs" proofs)
  | _ -> assert false

and prove_integers goal value =
  match rule_keys value [ "symbol"; "from"; "proofs" ] with
  | [ symbol; from; proofs ] ->
      let s = get_name "symbol" symbol and k = get_integer "from" (-1_000_000_000) 1_000_000_000 from in
      let proofs = get_list "proofs" proofs in
      let n = List.length proofs in
      let r = range_of goal s in
      if not r.integer then refuse "expected an integer symbol";
      let beyond t = match finite_ball no_symbols t with Some x -> is_above x | None -> false in
      (match (r.low, r.high) with
      | Some low, Some high ->
          shown "there are more integers" (beyond (subtract low (number (k - 1))) && beyond (subtract (number (k + n)) high))
      | _ -> refuse "integers: the range has no two ends");
      let at i =
        let change = put [ (s, number (k + i)) ] in
        let many = List.map change in
        {
          goal with
          tree = change goal.tree;
          exists = many goal.exists;
          given = many goal.given;
          zeros = many goal.zeros;
          box = List.remove_assoc s goal.box;
        }
      in
      List.iteri (fun i proof -> prove (at i) proof) proofs
  | _ -> assert false

and prove_abstract goal value =
  match rule_keys value [ "terms"; "ranges"; "to"; "inside"; "defined"; "proof" ] with
  | [ terms; ranges; target; inside; conditions; proof ] ->
      let read (u, v) =
        if (not (is_name u)) || List.mem_assoc u goal.box then refuse "abstract: expected new names";
        let t = get_tree "terms" v in
        check_symbols (premise goal t goal.relation);
        (u, t)
      in
      let terms = List.map read (get_object "terms" terms) in
      let ranges = get_object "ranges" ranges in
      same_length "ranges" terms ranges;
      let range_of_name (u, _) =
        match List.assoc_opt u ranges with
        | None -> refuse "abstract: the ranges have other names"
        | Some v ->
            let r = read_range u v in
            if r.nonzero || r.integer then refuse "abstract: a range with holes";
            (u, r)
      in
      let box = List.map range_of_name terms in
      let target = get_tree "to" target in
      let with_terms = put terms target in
      check_exponents_inside terms target;
      require_equal "abstract" goal.tree with_terms;
      let ends (u, t) =
        let r = List.assoc u box in
        let end_goal is_open distance = remember goal distance (if is_open then Above else AtLeast) in
        Option.to_list (Option.map (fun low -> end_goal r.open_low (subtract t low)) r.low)
        @ Option.to_list (Option.map (fun high -> end_goal r.open_high (subtract high t)) r.high)
      in
      prove_each "inside" (List.concat_map ends terms) (get_list "inside" inside);
      defined goal (with_terms :: List.map snd terms) conditions;
      let g = remember goal target goal.relation in
      prove { g with box = box @ g.box } proof
  | _ -> assert false

(* For every exponent of F: if it is rational with the terms in it, it is rational in F, too, with the same constant. *)
and check_exponents_inside terms t =
  (match t with
  | Pow (_, e) -> (
      match !constant (put terms e) with
      | Some q -> if !constant e <> Some q then refuse "an exponent changes"
      | None -> ())
  | _ -> ());
  List.iter (check_exponents_inside terms) (parts t)

and prove_solve goal value =
  match rule_keys value [ "share"; "atom"; "value"; "defined"; "proofs" ] with
  | [ share; atom; v; conditions; proofs ] ->
      require goal [ Equal ];
      let c = get_number "share" share and a = get_tree "atom" atom and v = get_tree "value" v in
      if Q.sign c = 0 then refuse "solve: a share 0";
      List.iter (fun t -> check_symbols (premise goal t goal.relation)) [ a; v ];
      let wanted = solve_premises a v in
      require_equal "solve" goal.tree (Prod [ Num c; subtract a v ]);
      defined goal [ a; v ] conditions;
      prove_each "solve" (List.map (fun (t, r) -> remember goal t r) wanted) (get_list "proofs" proofs)
  | _ -> assert false

and prove_squares goal value =
  match rule_keys value [ "left"; "right"; "sign"; "defined"; "proofs" ] with
  | [ left; right; sign; conditions; proofs ] ->
      require goal [ Equal; AtLeast; Above ];
      let l = get_tree "left" left and r = get_tree "right" right and sign = get_sign "sign" sign in
      if sign = -1 then require goal [ Equal ];
      List.iter (fun t -> check_symbols (premise goal t goal.relation)) [ l; r ];
      require_equal "squares" goal.tree (subtract l r);
      defined goal [ l; r ] conditions;
      let difference = remember goal (subtract (Prod [ l; l ]) (Prod [ r; r ])) goal.relation in
      let signs = if goal.relation = Equal then [ l; r ] else [ l ] in
      let goals = difference :: List.map (fun t -> remember goal (signed sign t) AtLeast) signs in
      prove_each "squares" goals (get_list "proofs" proofs)
  | _ -> assert false

and prove_balls goal value =
  match rule_keys value [ "bits"; "cells" ] with
  | [ bits; cells ] ->
      require goal [ Unequal; AtLeast; Above ];
      let bits = get_bits 20000 bits in
      let cells = get_integer "cells" 0 (most_cells bits) cells in
      at_precision bits (fun () -> check_cells goal (cells_allowed cells))
  | _ -> assert false

and check_cells goal cells =
  let names = List.fold_left symbols_in Names.empty (goal.tree :: goal.given) in
  let side name =
    let r = range_of goal name in
    match (r.low, r.high) with
    | Some low, Some high ->
        let low = number_ball name low in
        Some { low; length = less (number_ball name high) low; start = Z.zero; level = 0 }
    | _ -> None
  in
  let add name (sides, all) =
    match side name with Some s -> (Map_of_names.add name s sides, all) | None -> (sides, Names.add name all)
  in
  let box, free = Names.fold add names (Map_of_names.empty, Names.empty) in
  let settled cell =
    let balls = Map_of_names.map part_ball cell in
    let value name =
      match Map_of_names.find_opt name balls with
      | Some x -> x
      | None -> if Names.mem name free then everything else no_symbols name
    in
    let is_empty g = match ball Inside value g with x -> is_below x | exception Nowhere -> true | exception No_value -> false in
    let by_ball () =
      match ball Inside value goal.tree with
      | x -> satisfies goal.relation x
      | exception Nowhere -> true
      | exception No_value -> false
    in
    let by_mean () =
      Names.is_empty free && (not (Map_of_names.is_empty box))
      && match mean_value_ball balls cell goal.tree with x -> satisfies goal.relation x | exception No_value -> false
    in
    by_ball () || List.exists is_empty goal.given || by_mean ()
  in
  bisect ~cells ~names:(List.map fst (Map_of_names.bindings box)) ~settled box

and prove_given goal value =
  require goal [ AtLeast ];
  let weights = List.map (get_number "weights") (get_list "weights" (key_of value "weights")) in
  same_length "weights" goal.given weights;
  if List.exists (fun w -> Q.sign w < 0) weights then refuse "expected weights >= 0";
  let share = List.map2 (fun w g -> Prod [ Num w; g ]) weights goal.given in
  require_equal "given" goal.tree (sum_of (zero :: share))

and prove_range goal value =
  match rule_keys value [ "symbol"; "end"; "share" ] with
  | [ symbol; which; share ] ->
      require goal [ AtLeast; Above ];
      let s = get_name "symbol" symbol and which = get_integer "end" 0 1 which and c = get_number "share" share in
      if Q.sign c <= 0 then refuse "range: expected a share > 0";
      let r = range_of goal s in
      let limit, is_open = if which = 0 then (r.low, r.open_low) else (r.high, r.open_high) in
      let limit = match limit with Some t -> t | None -> refuse "range: a symbol without this end" in
      let distance = if which = 0 then subtract (Sym s) limit else subtract limit (Sym s) in
      require_equal "range" goal.tree (Prod [ Num c; distance ]);
      if goal.relation = Above then
        shown "range: the end belongs to the range" (is_open || (r.nonzero && vanishes limit))
  | _ -> assert false

and prove_angle goal value =
  match rule_keys value [ "turn"; "share"; "proofs" ] with
  | [ turn; share; proofs ] ->
      require goal [ AtLeast; Above ];
      let k = get_integer "turn" (-1_000_000) 1_000_000 turn and c = get_number "share" share in
      if Q.sign c <= 0 then refuse "angle: expected a share > 0";
      let is_wave = function Fun (("sin" | "cos"), _) -> true | _ -> false in
      let wave = match List.filter is_wave (factors goal.tree) with [ g ] -> g | _ -> refuse "angle: expected one sin or cos" in
      let v = match wave with Fun ("cos", [ u ]) -> Sum [ u; half_pi ] | Fun (_, [ u ]) -> u | _ -> assert false in
      let c = if k land 1 = 0 then c else Q.neg c in
      require_equal "angle" goal.tree (Prod [ Num c; wave ]);
      let turns n = Prod [ number n; Pi ] in
      let goals = [ remember goal (subtract v (turns k)) goal.relation; remember goal (subtract (turns (k + 1)) v) goal.relation ] in
      prove_each "angle" goals (get_list "proofs" proofs)
  | _ -> assert false

and prove_bounded goal value =
  require goal [ AtLeast; Above ];
  let tree, stays = bounded_tree goal.tree in
  prove (alone tree (if stays then AtLeast else goal.relation)) (key_of value "proof")

and prove_product goal value =
  require goal [ Unequal; AtLeast; Above ];
  let entries = get_list "factors" (key_of value "factors") in
  let parts = factors goal.tree in
  same_length "factors" parts entries;
  let sign = List.fold_left2 (fun sign t entry -> sign * factor_sign goal t entry) 1 parts entries in
  if sign <> 1 && goal.relation <> Unequal then refuse "product: the product is negative"

and factor_sign goal t entry =
  match (t, entry) with
  | Num c, Null ->
      if Q.sign c = 0 && goal.relation <> AtLeast then refuse "product: a factor 0";
      if Q.sign c < 0 then -1 else 1
  | Num _, _ -> refuse "product: a number needs no proof"
  | _, Null ->
      let even = is_even_part t and never = cannot_be_zero t in
      let fine = match goal.relation with AtLeast -> even | Above -> even && never | _ -> never in
      if not fine then refuse "product: a factor without a proof";
      1
  | _, List [ sign; proof ] ->
      let sign = get_sign "factors" sign in
      let b, q = match base_and_exponent t with Some p -> p | None -> refuse "product: an exponent that is not rational" in
      let even = is_even_part t in
      let relation =
        if goal.relation = AtLeast || Q.sign q < 0 then AtLeast
        else if even && goal.relation = Above then Unequal
        else goal.relation
      in
      prove (remember goal (signed sign b) relation) proof;
      if even then 1 else sign
  | _ -> refuse "product: expected null or [sign, proof]"

and prove_sum goal value =
  match rule_keys value [ "proofs"; "strict" ] with
  | [ proofs; strict ] ->
      require goal [ AtLeast; Above ];
      let proofs = get_list "proofs" proofs and parts = terms goal.tree in
      same_length "sum" parts proofs;
      let strict = match strict with Int z -> z | _ -> refuse "strict: expected an integer" in
      let is_strict i = goal.relation = Above && Z.equal (Z.of_int i) strict in
      if goal.relation = Above && (Z.sign strict < 0 || Z.geq strict (Z.of_int (List.length parts))) then
        refuse "sum: no term with this number";
      let prove_term i t proof = prove (remember goal t (if is_strict i then Above else AtLeast)) proof in
      List.iteri (fun i (t, proof) -> prove_term i t proof) (List.combine parts proofs)
  | _ -> assert false
