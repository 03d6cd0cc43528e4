(* The rules that prove goals. Section 7 of docs/certificates.md. *)

open Text
open Tree
open Ball
open Value
open Algebra
open Goal

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
      | "empty" -> (
          match rule_keys value [ "hypothesis"; "proof" ] with
          | [ k; proof ] ->
              let signs = List.map (fun h -> (negate h, Above)) goal.given @ List.map (fun h -> (h, Unequal)) goal.zeros in
              let tree, relation = List.nth signs (get_integer "hypothesis" 0 (List.length signs - 1) k) in
              prove (remember goal tree relation) proof
          | _ -> assert false)
      | "range" -> prove_range goal value
      | "angle" -> prove_angle goal value
      | "bounded" -> prove_bounded goal value
      | "product" -> prove_product goal value
      | "sum" -> prove_sum goal value
      | "corners" -> prove_corners goal value
      | "roots" -> prove_roots goal value
      | "quadratic" -> prove_quadratic goal value
      | "derivative" -> prove_derivative goal value
      | "slope" -> prove_slope goal value
      | "concave" -> prove_concave goal value
      | "dense" -> prove_dense goal value
      | "cones" ->
          require goal [ AtLeast; Above ];
          Cones.check goal (key_of value "splits")
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
      let cut side g = match u with Sym s -> cut_range g s side | _ -> g in
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
      let sign = get_sign "sign" sign in
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
      let k = get_integer "turn" (-1_000_000_000) 1_000_000_000 turn and c = get_number "share" share in
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

and prove_corners goal value =
  match rule_keys value [ "symbols"; "proofs" ] with
  | [ names; proofs ] ->
      require goal [ AtLeast; Above ];
      let names = List.map (get_name "symbols") (get_list "symbols" names) in
      if List.length (List.sort_uniq compare names) <> List.length names then refuse "corners: a name given twice";
      if List.length names > 16 then refuse "corners: more than 16 symbols";
      let ends name =
        match range_of goal name with
        | { low = Some low; high = Some high } -> [ (name, low); (name, high) ]
        | _ -> refuse "corners: a range without an end"
      in
      let sides = List.map ends names in
      check_degree_one names goal.tree;
      let rec choices = function
        | [] -> [ [] ]
        | side :: others -> let rest = choices others in List.concat_map (fun e -> List.map (List.cons e) rest) side
      in
      let box = List.filter (fun (s, _) -> not (List.mem s names)) goal.box in
      let corner choice = { (alone (put choice goal.tree) goal.relation) with box } in
      prove_each "corners" (List.map corner (choices sides)) (get_list "proofs" proofs)
  | _ -> assert false

and prove_roots goal value =
  match rule_keys value [ "from"; "to" ] with
  | [ from; to_ ] ->
      require goal [ Unequal; AtLeast; Above ];
      let s = match Names.elements (symbols goal.tree) with [ s ] -> s | _ -> refuse "roots: expected one symbol" in
      let r = range_of goal s in
      (* an end of the interval, and whether it is left out of the range *)
      let read what value limit is_open outward =
        match (value, limit) with
        | Null, _ -> (None, [])
        | _, None -> refuse "roots: a range without this end"
        | v, Some limit ->
            let x = get_number what v in
            let distance = outward (Num x) limit in
            if vanishes distance then (Some x, if is_open then [ x ] else [])
            else if (match finite_ball no_symbols distance with Some d -> is_above d | None -> false) then (Some x, [])
            else refuse "roots: an end inside the range"
      in
      let low, open_low = read "from" from r.low r.open_low (fun x limit -> subtract limit x) in
      let high, open_high = read "to" to_ r.high r.open_high subtract in
      let holes = open_low @ open_high @ if r.nonzero then [ Q.zero ] else [] in
      Calculus.check_roots goal.relation (Calculus.fraction s goal.tree) (low, high) holes
  | _ -> assert false

and prove_quadratic goal value =
  match rule_keys value [ "symbol"; "coefficients"; "defined"; "proofs" ] with
  | [ symbol; coefficients; conditions; proofs ] -> (
      require goal [ AtLeast; Above ];
      let s = get_name "symbol" symbol in
      let v = Sym s in
      match List.map (get_tree "coefficients") (get_list "coefficients" coefficients) with
      | [ a; b; c ] as all ->
          List.iter (fun t -> check_symbols (premise goal t goal.relation)) all;
          if List.exists (fun t -> Names.mem s (symbols t)) all then refuse "quadratic: the symbol in a coefficient";
          require_equal "quadratic" goal.tree (Sum [ Prod [ a; v; v ]; Prod [ b; v ]; c ]);
          defined goal all conditions;
          let rest = subtract (Prod [ number 4; a; c ]) (Prod [ b; b ]) in
          let goals = [ remember goal a AtLeast; remember goal c AtLeast; remember goal rest goal.relation ] in
          prove_each "quadratic" goals (get_list "proofs" proofs)
      | _ -> refuse "quadratic: expected 3 coefficients")
  | _ -> assert false

and prove_derivative goal value =
  match rule_keys value [ "point"; "value"; "slopes"; "defined" ] with
  | [ point; start; slopes; conditions ] ->
      require goal [ Equal ];
      if List.exists (fun (_, r) -> r.nonzero || r.integer) goal.box then refuse "derivative: a box with holes";
      let names = Names.elements (symbols goal.tree) in
      let point = read_numbers "point" point in
      check_point (List.map (fun s -> (s, range_of goal s)) names) point;
      prove (alone (put point goal.tree) Equal) start;
      let slopes_of_tree = List.map (fun s -> Calculus.derive s goal.tree) names in
      let free t = { (alone t Equal) with box = goal.box } in
      prove_each "slopes" (List.map free slopes_of_tree) (get_list "slopes" slopes);
      defined ~level:2 (free zero) (goal.tree :: slopes_of_tree) conditions
  | _ -> assert false

(* The conditions of `smooth`, each a goal in V without lists *)
and prove_smooth box f wanted value =
  let known = conditions 1 [ f ] in
  let once = List.fold_left (fun found c -> if List.mem c found then found else c :: found) [] wanted in
  let left = List.filter (fun c -> not (List.exists (fun k -> implies k c) known)) (List.rev once) in
  prove_each "smooth" (List.map (fun (r, t) -> { (alone t r) with box }) left) (get_list "smooth" value)

and prove_slope goal value =
  match rule_keys value [ "symbol"; "end"; "strict"; "continuous"; "smooth"; "slope"; "floor" ] with
  | [ symbol; which; strict; continuous; smooth; slope; floor ] ->
      require goal [ AtLeast; Above ];
      let s = get_name "symbol" symbol and at_high = get_integer "end" 0 1 which = 1 in
      let r = range_of goal s and f = goal.tree in
      let limit = match if at_high then r.high else r.low with Some t -> t | None -> refuse "slope: a range without this end" in
      let filled = { r with nonzero = false; integer = false } in
      let filled = if at_high then { filled with open_high = false } else { filled with open_low = false } in
      let inner = { filled with open_low = true; open_high = true } in
      let w = (with_range goal s filled).box and v = (with_range goal s inner).box in
      let rate = Calculus.derive s f in
      let left_out = if at_high then r.open_high else r.open_low in
      let strict = read_strict goal s inner rate left_out strict in
      defined ~level:1 { (alone zero Equal) with box = w } [ f ] continuous;
      prove_smooth v f (conditions 2 [ f ] @ conditions 0 [ rate ]) smooth;
      let is_above = goal.relation = Above in
      let rising = signed (if at_high then -1 else 1) rate in
      let curve = alone rising (if is_above && strict = `Rising then Above else AtLeast) in
      prove { curve with box = v; exists = [ f ] } slope;
      let start = alone (put [ (s, limit) ] f) (if is_above && strict = `Start then Above else AtLeast) in
      prove { start with box = List.remove_assoc s w } floor
  | _ -> assert false

(* Where the strictness of > comes from: the start, the slope, or a point at which the slope is not 0 *)
and read_strict goal s inner rate left_out value =
  let need_open () = if goal.relation = Above && not left_out then refuse "slope: the end belongs to the range" in
  match value with
  | Int z when Z.equal z Z.zero -> `Start
  | Int z when Z.equal z Z.one -> need_open (); `Rising
  | Text text ->
      need_open ();
      let t = read_tree text in
      if goal.relation = Above then begin
        if not (Names.equal (symbols goal.tree) (Names.singleton s)) then refuse "slope: a point with other symbols";
        check_inside s inner t;
        let x = number_ball s t in
        match finite_ball (fun _ -> x) rate with
        | Some y when not (has_zero y) -> ()
        | _ -> refuse "slope: the derivative may vanish at the point"
      end;
      `Point
  | _ -> refuse "slope: expected 0, 1 or a point"

and prove_concave goal value =
  match rule_keys value [ "symbol"; "continuous"; "smooth"; "curve"; "floors" ] with
  | [ symbol; continuous; smooth; curve; floors ] ->
      require goal [ AtLeast ];
      let s = get_name "symbol" symbol in
      let r = range_of goal s and f = goal.tree in
      let low, high =
        match (r.low, r.high) with Some low, Some high -> (low, high) | _ -> refuse "concave: a range without an end"
      in
      let closed = { anything with low = Some low; high = Some high } in
      let w = (with_range goal s closed).box in
      let v = (with_range goal s { closed with open_low = true; open_high = true }).box in
      let rate = Calculus.derive s f in
      let bend = Calculus.derive s rate in
      defined ~level:1 { (alone zero Equal) with box = w } [ f ] continuous;
      prove_smooth v f (conditions 2 [ f; rate ] @ conditions 0 [ bend ]) smooth;
      prove { (alone (negate bend) AtLeast) with box = v; exists = [ f ] } curve;
      let floor t = { (alone (put [ (s, t) ] f) AtLeast) with box = List.remove_assoc s w } in
      prove_each "floors" [ floor low; floor high ] (get_list "floors" floors)
  | _ -> assert false

and prove_dense goal value =
  match rule_keys value [ "except"; "point"; "defined"; "proof" ] with
  | [ except; point; conditions; proof ] ->
      require goal [ AtLeast ];
      let h = get_tree "except" except in
      check_entire h;
      let read (name, v) = if is_name name then (name, of_rational (get_number "point" v)) else refuse "point: expected a name" in
      let point = List.map read (get_object "point" point) in
      let value name = match List.assoc_opt name point with Some x -> x | None -> no_symbols name in
      (match finite_ball value h with
      | Some x when not (has_zero x) -> ()
      | _ -> refuse "dense: the exception may vanish throughout");
      let fill (name, r) =
        let wide =
          match (r.low, r.high) with
          | Some low, Some high -> ( match finite_ball no_symbols (subtract high low) with Some d -> is_above d | None -> false)
          | _ -> true
        in
        if r.integer || not wide then refuse "dense: a range without inner points";
        (name, { r with open_low = false; open_high = false; nonzero = false })
      in
      let w = List.map fill goal.box in
      defined ~level:1 { (alone zero AtLeast) with box = w } (goal.tree :: goal.exists) conditions;
      let away = Pow (h, Num Q.minus_one) in
      prove { goal with exists = away :: goal.exists; given = []; zeros = [] } proof
  | _ -> assert false
